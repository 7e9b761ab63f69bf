"""The filter after and without a batch, and the bound."""

import numpy as np
import pytest
from scipy.stats import chi2

from debrisest.assessment.shape_alignment import best_rotation, rms_distance
from debrisest.filters.bound.landmarks import landmark_bound
from debrisest.filters.landmark_model import points_of
from debrisest.filters.landmarks.cost import Prior, Unknowns, cost
from debrisest.filters.landmarks.landmark_filter import Annealing, landmark_filter
from debrisest.filters.landmarks.update import Belief, UpdateSettings
from debrisest.filters.status import ReplayStatus
from debrisest.problems.camera_range.projection import landmark_model

MOVING = slice(3, 17)


@pytest.fixture(scope="module")
def filtered(nominal):
    case, started = nominal
    return case, started, case.filtered(started, false_alarm=None)


def core_error(case, found, epoch=-1):
    state = found.state[:, epoch, : case.core.shape[-1]]
    return case.model.difference(state, case.core[:, epoch])


def test_innovations_and_errors_are_consistent(filtered) -> None:
    case, _, found = filtered
    result = found
    used = result.nis_dof.sum()
    low, high = chi2.ppf([1e-4, 1 - 1e-4], used)
    assert low < np.nansum(result.nis) < high
    error = core_error(case, found)[:, MOVING]
    covariance = result.covariance[:, -1, MOVING, MOVING]
    squares = (error[:, None] @ np.linalg.solve(covariance, error[..., None]))[:, 0, 0]
    assert squares.sum() < 1.5 * chi2.isf(1e-4, error.size)
    assert (result.status == ReplayStatus.CONVERGED.sentence).all()


def test_the_gate_rejects_as_many_as_it_should(nominal) -> None:
    case, started = nominal
    found = case.filtered(started)
    rejected, looked = found.counts["rejected"].sum() / 2, 49 * 4 * case.model.landmarks
    assert rejected < 1e-3 * looked + 5 * np.sqrt(1e-3 * looked) + 1


def test_frames_of_the_batch_are_not_used_again(nominal) -> None:
    case, started = nominal
    late = started._replace(last=np.full(4, 200))
    result = case.filtered(late)
    cores, transitions = case.model.trajectory(started.core, 149)
    np.testing.assert_allclose(result.state[:, :, :18], cores, atol=1e-9)
    assert result.nis_dof.sum() == 0
    n_c = case.model.errors
    last = transitions[:, -1]
    spread = last @ started.covariance[:, :n_c, :n_c] @ np.swapaxes(last, -1, -2)
    size = np.sqrt(np.diagonal(spread, 0, 1, 2))
    np.testing.assert_allclose(result.sigma[:, -1, :n_c], size, rtol=1e-4, atol=1e-9)


def test_masked_is_absent_to_the_last_bit(nominal) -> None:
    case, started = nominal
    hidden = case.observed.seen.copy()
    hidden[:, 101:, 5] = False
    noisy = case.observed.shown.copy()
    noisy[:, 101:, 5] = 1e3
    results = [
        case.with_observed(case.observed._replace(seen=hidden, shown=shown)).filtered(started)
        for shown in (case.observed.shown, noisy)
    ]
    np.testing.assert_array_equal(results[0].state, results[1].state)
    np.testing.assert_array_equal(results[0].covariance, results[1].covariance)


def test_an_absent_landmark_leaves_the_others_as_they_are(nominal) -> None:
    """Dropped before the filter, a landmark counts neither by its errors nor by its pixels."""
    case, started = nominal
    kept = np.r_[0:17, 17:32, 35:50]
    present = started.present.copy()
    present[:, 5] = False
    covariance = started.covariance.copy()
    covariance[:, 32:35] = covariance[:, :, 32:35] = 0.0
    observed = case.observed._replace(seen=case.observed.seen.copy())
    observed.seen[:, :, 5] = False
    without = started._replace(present=present, covariance=covariance)
    found = case.with_observed(observed).filtered(without)
    rest = np.delete(np.arange(11), 5)
    model = landmark_model(case.known._replace(points=10))
    small = case._replace(
        model=model,
        observed=observed._replace(
            shown=observed.shown[:, :, rest], seen=observed.seen[:, :, rest]
        ),
    )
    begun = without._replace(
        points=started.points[:, rest],
        covariance=covariance[:, kept[:, None], kept],
        present=present[:, rest],
    )
    alone = small.filtered(begun)
    assert np.isnan(found.state[:, -1, 18 + 15 : 18 + 18]).all()
    np.testing.assert_allclose(found.state[..., :18], alone.state[..., :18], atol=1e-9)
    np.testing.assert_allclose(found.sigma[..., :17], alone.sigma[..., :17], rtol=1e-6, atol=1e-12)


def test_without_a_gate_false_matches_spoil_the_estimate(experiment) -> None:
    case = experiment(2, 150, 11, false_share=0.1)
    started = case.batch(robust=True)
    errors = [
        np.abs(core_error(case, case.filtered(started, false_alarm=limit))[:, 3:9]).max(-1)
        for limit in (1e-3, None)
    ]
    assert (errors[0] < 0.02).all()
    assert (~(errors[1] < 5 * errors[0])).all()


def test_a_landmark_that_jumps_is_dropped_and_inserted_anew(nominal) -> None:
    case, started = nominal
    shown = case.observed.shown.copy()
    shown[:, 110:, 2] += 300.0
    found = case.with_observed(case.observed._replace(shown=shown)).filtered(started)
    points = points_of(case.model, found.state)
    assert np.isfinite(points[:, 114, 2]).all()
    assert np.isnan(points[:, 117, 2]).all()
    assert np.isfinite(np.delete(points, 2, axis=2)[:, 120:]).all()
    assert (found.counts["dropped"] >= 1).all()
    assert np.abs(core_error(case, found)[:, 6:9]).max() < 0.03


def test_a_lost_run_leaves_the_others_alone(nominal) -> None:
    case, started = nominal
    core = started.core.copy()
    core[1] = np.nan
    result = case.filtered(started._replace(core=core))
    whole = case.filtered(started)
    assert result.status[1] == ReplayStatus.NO_START.sentence
    assert np.isnan(result.state[1]).all()
    np.testing.assert_array_equal(result.state[[0, 2, 3]], whole.state[[0, 2, 3]])


@pytest.mark.parametrize("range_to", ["bias", "landmark"])
def test_ranges_that_are_not_those_of_the_centre(experiment, range_to: str) -> None:
    case = experiment(2, 130, 12, range_to=range_to)
    started = case.batch()
    found = case.filtered(started)
    error = core_error(case, found)
    sigma = found.sigma[:, -1, : case.model.errors]
    assert (np.abs(error[:, 3:]) < 5 * sigma[:, 3:] + 1e-9).all()
    assert np.abs(error[:, 6:9]).max() < 0.2


def test_white_noise_of_the_attitude_is_shared_by_the_points(experiment) -> None:
    case = experiment(2, 102, 13, noise=0.0)
    noise = np.radians(0.2)
    model = landmark_model(case.known._replace(attitude_sigma=noise))
    rows = model.rows(case.core[:, :1], case.points[:, None], np.array([0]))
    turned = rows.shared[0, 0] / noise
    assert turned.shape == (11, 2, 3)
    # a turn about the optical axis moves a pixel across its radius, by the angle
    across = np.stack([rows.shown[0, 0, :, 1], -rows.shown[0, 0, :, 0]], axis=-1)
    np.testing.assert_allclose(turned[..., 2], across, atol=1e-9)
    at = Unknowns(model.parameters(case.core[:, 0]), case.points, np.ones((2, 11), dtype=bool))
    prior = Prior(at.vector, np.tile(np.eye(47), (2, 1, 1)))
    frames = np.arange(0, 40, 3)
    found = cost(model, case.observed, prior, at, frames, False)
    reference = dense_information(model, case, frames, noise=True)
    np.testing.assert_allclose(found.information, reference, rtol=1e-6, atol=1e-3)


def dense_information(model, case, frames, noise):
    """Information of all unknowns by the textbook: rows times inverse covariance times rows."""
    core, by_parameters = model.start(model.parameters(case.core[:, 0]))
    cores, transitions = model.trajectory(core, int(frames[-1]))
    total = np.tile(np.eye(47), (len(core), 1, 1))
    for k in frames:
        rows = model.rows(cores[:, k : k + 1], case.points[:, None], np.array([k]))
        for run in range(len(core)):
            by_start = (transitions[run, k] @ by_parameters[run])[model.shown_by]
            h = np.zeros((23, 47))
            h[:22, :14] = rows.by_core[run, 0].reshape(22, -1) @ by_start
            for i in range(11):
                h[2 * i : 2 * i + 2, 14 + 3 * i : 17 + 3 * i] = rows.by_point[run, 0, i]
            h[22, :14] = rows.common_by_core[run, 0, 0] @ by_start
            covariance = np.diag(np.append(np.ones(22), 1e-4))
            if noise:
                shared = rows.shared[run, 0].reshape(22, 3)
                covariance[:22, :22] += shared @ shared.T
            total[run] += h.T @ np.linalg.solve(covariance, h)
    return total


@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_the_bound_is_the_inverse_information(experiment, noise: float) -> None:
    case = experiment(2, 40, 14)
    model = landmark_model(case.known._replace(attitude_sigma=np.radians(noise)))
    wide = np.tile(np.eye(47), (2, 1, 1))
    bound = landmark_bound(
        model, case.core[:, 0], case.points, case.parameters, wide, case.observed, [0, 39]
    )
    information = dense_information(model, case, np.arange(40), noise > 0)
    start = np.linalg.inv(information)
    _, transitions = model.trajectory(case.core[:, 0], 39)
    moved = np.tile(np.eye(50)[:, 3:], (2, 1, 1))
    moved[:, :17, :14] = transitions[:, -1] @ np.eye(17)[:, 3:]
    expected = moved @ start @ np.swapaxes(moved, -1, -2)
    size = np.sqrt(np.diagonal(expected, 0, 1, 2))
    np.testing.assert_allclose(bound.sigma[:, -1], size, rtol=1e-5, atol=1e-12)
    np.testing.assert_allclose(bound.covariance[:, -1], expected, atol=1e-6 * size.max() ** 2)


def test_the_filter_is_near_the_bound(filtered) -> None:
    case, _, found = filtered
    bound = landmark_bound(
        *(case.model, case.core[:, 0], case.points, case.parameters, case.covariance, case.observed)
    )
    sigma = found.sigma[:, -1, MOVING]
    assert (sigma > 0.95 * bound.sigma[:, -1, MOVING]).all()
    assert (sigma < 1.4 * bound.sigma[:, -1, MOVING]).all()
    error = core_error(case, found)[:, MOVING]
    assert (np.abs(error - bound.error[:, -1, MOVING]) < 2.5 * sigma).all()


def test_without_a_batch_the_shape_comes_out_but_for_its_gauge(experiment) -> None:
    case = experiment(4, 150, 15, guess=0.7)
    core, by_parameters = case.model.start(case.parameters)
    covariance = np.zeros((4, 50, 50))
    inner = case.covariance[:, :14, :14]
    covariance[:, :17, :17] = by_parameters @ inner @ np.swapaxes(by_parameters, -1, -2)
    covariance[:, :3, :3] += np.radians(5.0) ** 2 * np.eye(3)
    found = landmark_filter(
        case.model,
        Belief(core, np.zeros((4, 11, 3)), covariance),
        np.zeros((4, 11), dtype=bool),
        np.full(4, -1),
        case.observed,
        UpdateSettings(),
        Annealing(100.0, 20.0),
    )
    points = points_of(case.model, found.state[:, -1])
    turned = points @ np.swapaxes(best_rotation(points, case.points), -1, -2)
    errors = np.sort(rms_distance(turned, case.points))
    assert errors[2] < 0.05
    assert found.nis_dof[0, 0] == 1  # the first frame places landmarks, and updates none
