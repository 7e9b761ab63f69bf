"""Keys of the association filters, and what they hand to the numerics."""

import numpy as np
import pytest
from pydantic import ValidationError

from debrisest.clock import Clock
from debrisest.filters.scan_model import ScanModel
from debrisest.filters.verdict import Verdict
from debrisest.parts.filters.association import (
    AssociationFilter,
    JointAssociation,
    KnownAssociation,
)
from debrisest.parts.filters.bound import LinearisedAtTruth
from debrisest.roles import Given

RUNS, EPOCHS = 3, 9
F = np.array([[1.0, 2.0], [0.0, 1.0]])
H = np.stack([np.eye(2), [[1.0, 0.5], [0.0, 1.0]]])


def points(x, _):
    """Curved, so that it matters where they are linearised."""
    shown = (H @ x[..., None, :, None])[..., 0]
    return shown + 0.05 * shown**2


def points_jacobian(x, _):
    shown = (H @ x[..., None, :, None])[..., 0]
    return (1.0 + 0.1 * shown)[..., None] * H


MODEL = ScanModel(
    process=lambda x, _: x @ F.T,
    process_jacobian=lambda _x, _k: F,
    process_noise=1e-3 * np.eye(2),
    points=points,
    points_jacobian=points_jacobian,
    noise=0.25 * np.eye(2),
    error_names=("x", "v"),
)


@pytest.fixture
def given() -> Given:
    rng = np.random.default_rng(0)
    truth = np.empty((RUNS, EPOCHS, 2))
    truth[:, 0] = [1.0, 0.3]
    for k in range(1, EPOCHS):
        truth[:, k] = truth[:, k - 1] @ F.T
    own = points(truth, 0) + 0.5 * rng.normal(size=(RUNS, EPOCHS, 2, 2))
    clutter = own + rng.normal(size=own.shape)
    clutter[:, ::2] = np.nan
    scans = np.stack([own, clutter], axis=-2)
    guess = truth[:, 0] + 0.3 * rng.normal(size=(RUNS, 2))
    covariance = np.stack([0.09 * np.eye(2)] * RUNS)
    return Given(guess, covariance, scans, Clock.regular((EPOCHS - 1) * 2.0, 2.0), truth)


def associate(**keys):
    return AssociationFilter.model_validate({"kind": "association", **keys})


def alone(given):
    return given._replace(measured=given.measured[..., :1, :])


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("detection_probability", 0.0),
        ("detection_probability", 1.5),
        ("gate", 0.0),
        ("gate", -5.0),
        ("gate_probability", 0.0),
        ("gate_volume", "guessed"),
        ("method", "known"),
        ("linearised", "guess"),
        ("relinearised_s", 10.0),
    ],
)
def test_a_key_without_sense_is_refused_by_its_name(key, value):
    with pytest.raises(ValidationError, match=key):
        associate(**{key: value})


@pytest.mark.parametrize(
    "change",
    [
        {"method": "nearest"},
        {"gate": 1.0},
        {"detection_probability": 0.3},
        {"gate_probability": 0.5},
        {"gate_volume": "inverse_unit_ball"},
        {"stacked": True},
        {"linearised": "start"},
        {"linearised": "truth"},
        {"linearised": "start", "relinearised_s": 6.0},
    ],
)
def test_every_key_reaches_the_estimate(given, change):
    plain, changed = associate().run(MODEL, given), associate(**change).run(MODEL, given)
    assert not np.allclose(plain.state, changed.state, rtol=1e-9)
    assert np.isfinite(changed.state).all()
    assert (changed.counts["doubt"] < Verdict.LOST).all()


def test_relinearised_at_every_step_is_linearised_about_the_estimate(given):
    every = associate(linearised="start", relinearised_s=2.0).run(MODEL, given)
    assert np.array_equal(every.state, associate().run(MODEL, given).state)


def test_validated_detections_are_counted_and_have_no_nis(given):
    wide = associate(gate=1e6).run(MODEL, given)
    expected = np.where(np.arange(EPOCHS) % 2 == 0, 2, 4)
    assert np.array_equal(wide.counts["validated"], np.tile(expected, (RUNS, 1)))
    narrow = associate(gate=1.0).run(MODEL, given)
    assert (narrow.counts["validated"] <= wide.counts["validated"]).all()
    assert narrow.counts["validated"].sum() < wide.counts["validated"].sum()
    assert np.isnan(wide.nis).all()
    assert not wide.nis_dof.any()


def test_detections_of_a_sensor_that_predicts_nothing_are_not_validated(given):
    def half_blind(x, k):
        shown = points(x, k)
        shown[..., 0, :] = np.nan
        return shown

    model = MODEL._replace(points=half_blind)
    found = associate(gate=1e6).run(model, given).counts["validated"]
    assert np.array_equal(found, associate(gate=1e6).run(MODEL, given).counts["validated"] // 2)
    lost = given.state.copy()
    lost[1] = np.nan
    counts = associate(gate=1e6).run(MODEL, given._replace(state=lost)).counts["validated"]
    assert not counts[1].any() and counts[[0, 2]].all()


def test_joint_association_returns_the_first_track(given):
    joint = JointAssociation(kind="joint_association")
    tracks = given._replace(
        state=np.stack([given.state, given.state + 50.0], axis=1),
        covariance=np.stack([given.covariance] * 2, axis=1),
    )
    expected = associate().run(MODEL, given)
    assert np.allclose(joint.run(MODEL, tracks).state, expected.state, rtol=1e-12)


def test_known_detections_have_a_nis_and_the_bound_knows_the_truth(given):
    known = KnownAssociation(kind="known_association", keep_s=[4.0]).run(MODEL, alone(given))
    bound = LinearisedAtTruth(kind="linearised_at_truth", keep_s=[4.0]).run(MODEL, alone(given))
    assert known.kept.tolist() == bound.kept.tolist() == [2, EPOCHS - 1]
    assert np.array_equal(known.nis_dof, np.full((RUNS, EPOCHS), 4))
    assert not np.array_equal(known.state, bound.state)
    blind = alone(given)._replace(truth=None)
    for part in (LinearisedAtTruth(kind="linearised_at_truth"), associate(linearised="truth")):
        with pytest.raises(ValueError, match="truth"):
            part.run(MODEL, blind)


def test_a_bound_that_its_own_errors_leave_says_so(given):
    bound = LinearisedAtTruth(kind="linearised_at_truth")
    assert bound.run(MODEL, alone(given)).status.tolist() == ["consistent"] * RUNS
    away = given.truth.copy()
    away[1] += 0.5 * np.arange(EPOCHS)[:, None] ** 2
    found = bound.run(MODEL, alone(given)._replace(truth=away))
    assert found.counts["doubt"].tolist() == [0, Verdict.LARGER, 0]
    assert "this is no bound" in found.status[1]


def test_pieces_that_stay_beside_the_target_are_told(given):
    rng = np.random.default_rng(3)
    epochs = 150
    truth = np.stack([np.tile([1.0, 0.0], (epochs, 1))] * RUNS)
    own = points(truth, 0) + 0.5 * rng.normal(size=(RUNS, epochs, 2, 2))
    crowd = rng.uniform(-8.0, 8.0, size=(2, RUNS, epochs, 2, 2))
    stays = points(truth, 0) + [6.0, -5.0] + 0.5 * rng.normal(size=crowd.shape)
    for beside, doubt in ((crowd + own, 0), (stays, Verdict.LARGER)):
        scans = np.stack([own, *beside], axis=-2)
        seen = given._replace(measured=scans, clock=Clock.regular(2.0 * epochs - 2.0, 2.0))
        found = associate().run(MODEL, seen._replace(state=truth[:, 0] + 0.1))
        assert found.counts["doubt"].tolist() == [doubt] * RUNS
