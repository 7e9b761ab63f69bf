"""Filters of unlabelled detections, run by run against what they must equal."""

import numpy as np
import pytest

from debrisest.filters.association.single import associated, jointly_associated, labelled
from debrisest.filters.association.weights import Validation
from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model
from debrisest.filters.scan_model import ScanModel
from debrisest.filters.status import FilterStatus

RUNS, EPOCHS, SENSORS = 6, 25, 3
F = np.eye(4) + np.eye(4, k=2)
INPUT = np.concatenate([0.5 * np.eye(2), np.eye(2)])
Q = 0.01 * INPUT @ INPUT.T  # of rank 2
R = np.array([[1e-4, 2e-5], [2e-5, 2e-4]])
P0 = np.diag([0.25, 0.25, 0.04, 0.04])
EYES = np.array([[-20.0, 0.0], [0.0, -25.0], [30.0, 30.0]])
START = np.array([2.0, -1.0, 0.3, -0.2])
RULE = Validation(gate=12.0, detection_probability=0.9)


def process(x, _):
    """Nearly straight: drag grows with the speed."""
    speed = np.linalg.norm(x[..., 2:], axis=-1, keepdims=True)
    moved = x @ F.T
    return np.concatenate([moved[..., :2], moved[..., 2:] * (1 - 0.02 * speed)], axis=-1)


def process_jacobian(x, _):
    v = x[..., 2:]
    speed = np.linalg.norm(v, axis=-1)[..., None, None]
    jacobian = np.broadcast_to(F, (*x.shape[:-1], 4, 4)).copy()
    outer = v[..., :, None] * v[..., None, :]
    jacobian[..., 2:, 2:] = (1 - 0.02 * speed) * np.eye(2) - 0.02 * outer / speed
    return jacobian


def points(x, _):
    """Bearing and logarithm of the distance."""
    ray = x[..., None, :2] - EYES
    bearing = np.arctan2(ray[..., 1], ray[..., 0])
    return np.stack([bearing, np.log(np.linalg.norm(ray, axis=-1))], axis=-1)


def points_jacobian(x, _):
    ray = x[..., None, :2] - EYES
    squared = (ray**2).sum(-1)[..., None]
    rows = np.stack([np.stack([-ray[..., 1], ray[..., 0]], -1), ray], axis=-2) / squared[..., None]
    return np.concatenate([rows, np.zeros_like(rows)], axis=-1)


MODEL = ScanModel(process, process_jacobian, Q, points, points_jacobian, R, ("x", "y", "u", "v"))


def campaign(seed, clutter=0, missing=0.0, runs=RUNS, width=0.05):
    """Truth, scans whose first detection is the target's, first guess."""
    rng = np.random.default_rng(seed)
    truth = np.empty((runs, EPOCHS, 4))
    truth[:, 0] = START
    for k in range(1, EPOCHS):
        pushed = 0.1 * rng.normal(size=(runs, 2)) @ INPUT.T
        truth[:, k] = process(truth[:, k - 1], k) + pushed
    shown = points(truth, 0)
    own = shown + rng.multivariate_normal(np.zeros(2), R, size=shown.shape[:3])
    own[rng.random(shown.shape[:3]) < missing] = np.nan
    size = (*shown.shape[:3], clutter, 2)
    around = shown[..., None, :] + rng.uniform(-width, width, size=size)
    guess = truth[:, 0] + rng.multivariate_normal(np.zeros(4), P0, size=runs)
    return truth, np.concatenate([own[..., None, :], around], axis=-2), guess, np.stack([P0] * runs)


def same(a, b, rtol=1e-9):
    for name in ("state", "sigma", "covariance", "nis"):
        first, second = getattr(a, name), getattr(b, name)
        np.testing.assert_allclose(first, second, rtol=rtol, atol=1e-12, err_msg=name)
    assert np.array_equal(a.nis_dof, b.nis_dof)


@pytest.mark.parametrize("stacked", [False, True])
@pytest.mark.parametrize("method", ["probabilistic", "nearest", "known"])
def test_a_single_certain_detection_makes_it_the_extended_filter(method, stacked):
    _, scans, guess, covariance = campaign(0, missing=0.0 if method == "probabilistic" else 0.3)
    stack = scans.reshape(RUNS, EPOCHS, 2 * SENSORS)
    model = Model(
        process,
        lambda x, k: points(x, k).reshape(*x.shape[:-1], 2 * SENSORS),
        Q,
        np.kron(np.eye(SENSORS), R),
        MODEL.error_names,
        process_jacobian=process_jacobian,
        measurement_jacobian=lambda x, k: points_jacobian(x, k).reshape(-1, 2 * SENSORS, 4),
    )
    certain = Validation(gate=np.inf, detection_probability=1.0)
    found = associated(
        *(MODEL, guess, covariance, scans, certain), method=method, stacked=stacked, keep=[3]
    )
    expected = extended(model, guess, covariance, stack, keep=[3])
    if stacked:  # its NIS are taken sensor by sensor
        found = found._replace(nis=expected.nis)
    same(found, expected)


@pytest.mark.parametrize("method", ["probabilistic", "nearest"])
def test_neither_order_nor_padding_of_detections_matters(method):
    _, scans, guess, covariance = campaign(1, clutter=3, missing=0.2)
    before = associated(MODEL, guess, covariance, scans, RULE, method=method)
    padded = np.concatenate([np.full((*scans.shape[:3], 2, 2), np.nan), scans], axis=-2)
    order = np.argsort(np.random.default_rng(2).random(padded.shape[:4]), axis=-1)
    mixed = np.take_along_axis(padded, order[..., None], axis=-2)
    same(associated(MODEL, guess, covariance, mixed, RULE, method=method), before)


def test_clutter_outside_the_gate_changes_nothing_but_its_count() -> None:
    _, scans, guess, covariance = campaign(2, clutter=1)
    far = np.full((*scans.shape[:3], 1, 2), 50.0)
    before = associated(MODEL, guess, covariance, scans, RULE)
    after = associated(MODEL, guess, covariance, np.concatenate([scans, far], -2), RULE)
    same(after, before, rtol=1e-12)
    assert np.array_equal(
        after.counts["rejected"] - before.counts["rejected"], np.full((RUNS, EPOCHS), 2 * SENSORS)
    )


def test_scans_without_detections_are_mere_prediction() -> None:
    _, scans, guess, covariance = campaign(3)
    history = associated(MODEL, guess, covariance, np.full_like(scans, np.nan), RULE)
    state = guess
    for k in range(1, EPOCHS):
        slope = process_jacobian(state, k)
        covariance = slope @ covariance @ np.swapaxes(slope, -1, -2) + Q
        state = process(state, k)
    np.testing.assert_allclose(history.state[:, -1], state, rtol=1e-12)
    np.testing.assert_allclose(history.covariance[:, -1], covariance, rtol=1e-10)
    assert not history.nis_dof.any()
    assert not history.nis.any()


def test_linearised_about_the_start_it_is_the_small_disturbance_filter() -> None:
    """Kalman filter of the disturbance of a nominal motion that nothing corrects."""
    _, scans, guess, covariance = campaign(4)
    found = associated(
        *(MODEL, guess, covariance, scans, Validation()), method="known", relinearise=0
    )
    for run in range(RUNS):
        nominal, small, p = guess[run], np.zeros(4), covariance[run]
        for k in range(EPOCHS):
            if k > 0:
                slope = process_jacobian(nominal, k)
                small, p, nominal = slope @ small, slope @ p @ slope.T + Q, process(nominal, k)
            h = points_jacobian(nominal, k).reshape(-1, 4)
            y = (scans[run, k, :, 0] - points(nominal, k)).ravel()
            gain = p @ h.T @ np.linalg.inv(h @ p @ h.T + np.kron(np.eye(SENSORS), R))
            small, p = small + gain @ (y - h @ small), p - gain @ h @ p
            np.testing.assert_allclose(found.state[run, k], nominal + small, rtol=1e-8, atol=1e-9)
        np.testing.assert_allclose(found.covariance[run, -1], p, rtol=1e-6, atol=1e-12)


def test_relinearised_at_the_end_of_each_stretch() -> None:
    """A stretch between two linearisations is a filter of its own, started at the estimate."""
    _, scans, guess, covariance = campaign(5, clutter=2)
    whole = associated(MODEL, guess, covariance, scans, RULE, relinearise=10, keep=range(EPOCHS))
    first = associated(MODEL, guess, covariance, scans[:, :10], RULE, relinearise=0)
    np.testing.assert_array_equal(whole.state[:, :10], first.state)
    blank = np.concatenate([np.full_like(scans[:, :1], np.nan), scans[:, 10:20]], axis=1)
    second = associated(
        *(MODEL, first.state[:, -1], first.covariance[:, -1], blank, RULE), relinearise=0
    )
    np.testing.assert_allclose(whole.state[:, 10:20], second.state[:, 1:], rtol=1e-10)


@pytest.mark.parametrize("joint", [False, True])
def test_a_run_does_not_depend_on_its_companions(joint):
    _, scans, guess, covariance = campaign(6, clutter=2, missing=0.1)
    if joint:
        guess, covariance = np.stack([guess, guess + 1.0], 1), np.stack([covariance] * 2, 1)
    run = jointly_associated if joint else associated
    together = run(MODEL, guess, covariance, scans, RULE)
    guess[0, ..., 0] = np.inf
    scans[1, 4] = 1e200
    spoiled = run(MODEL, guess, covariance, scans, RULE)
    alone = run(MODEL, guess[2:4], covariance[2:4], scans[2:4], RULE)
    assert spoiled.status[0] == FilterStatus.NO_START.sentence
    for name in ("state", "sigma", "covariance", "nis", "nis_dof"):
        assert np.array_equal(getattr(spoiled, name)[2:], getattr(together, name)[2:]), name
        assert np.array_equal(getattr(alone, name), getattr(together, name)[2:4]), name
    for name, values in together.counts.items():
        assert np.array_equal(spoiled.counts[name][2:], values[2:]), name
        assert np.array_equal(alone.counts[name], values[2:4]), name


def test_a_run_that_diverges_ends_there() -> None:
    _, scans, guess, covariance = campaign(7)

    def broken(runs):
        wrong = (runs == 2)[:, None, None]
        return MODEL._replace(
            process=lambda x, k: np.where((k == 5) & wrong, np.inf, process(x, k)),
            select=lambda chosen: broken(runs[chosen]),
        )

    history = associated(broken(np.arange(RUNS)), guess, covariance, scans, RULE)
    assert history.diverged_at.tolist() == [-1, -1, 6, -1, -1, -1]
    assert np.isnan(history.state[2, 6:]).all()
    assert np.isfinite(history.state[:, :6]).all()


def test_a_single_track_is_associated_jointly_as_alone() -> None:
    _, scans, guess, covariance = campaign(8, clutter=3, missing=0.1)
    alone = associated(MODEL, guess, covariance, scans, RULE)
    same(jointly_associated(MODEL, guess[:, None], covariance[:, None], scans, RULE), alone)
    nobody = np.stack([guess, np.full_like(guess, np.nan)], axis=1)
    double = np.stack([covariance, covariance], axis=1)
    same(jointly_associated(MODEL, nobody, double, scans, RULE), alone)


def test_only_the_chosen_detection_is_left() -> None:
    _, scans, _, _ = campaign(9, clutter=3)
    index = np.random.default_rng(0).integers(-1, 4, size=scans.shape[:3])
    found = labelled(scans, index)[..., 0, :]
    for place in np.ndindex(index.shape):
        expected = scans[place][index[place]] if index[place] >= 0 else np.full(2, np.nan)
        assert np.array_equal(found[place], expected, equal_nan=True)


def test_what_makes_no_sense_is_refused() -> None:
    _, scans, guess, covariance = campaign(0, clutter=1)
    with pytest.raises(ValueError, match="alone"):
        associated(MODEL, guess, covariance, scans, RULE, method="known")
    with pytest.raises(ValueError, match="method"):
        associated(MODEL, guess, covariance, scans, RULE, method="best")
    for method in ("probabilistic", "nearest"):
        with pytest.raises(ValueError, match="detection probability"):
            associated(MODEL, guess, covariance, scans, Validation(9.0, 1.5), method=method)
