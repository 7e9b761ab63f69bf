"""Turns of the body axes: what they leave alone, and what a filter may claim of them."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.dynamics import log_inertia
from debrisest.filters.landmark_model import joined
from debrisest.filters.landmarks.gauge import honest, information
from debrisest.filters.landmarks.landmark_filter import Annealing, landmark_filter
from debrisest.filters.landmarks.update import Belief, UpdateSettings

TURN = np.array([0.3, -0.5, 0.2])


def turned(core: np.ndarray, points: np.ndarray, angle: np.ndarray):
    """Core and points of body axes turned by a finite angle."""
    turn = quaternion.exp(angle)
    to_new = quaternion.to_matrix(turn).T
    result = core.copy()
    result[..., :4] = quaternion.multiply(core[..., :4], turn)
    result[..., 4:7] = core[..., 4:7] @ to_new.T
    tensor = to_new @ log_inertia.inertia(core[..., 13:18]) @ to_new.T
    result[..., 13:18] = log_inertia.log_ratios(tensor)
    return result, points @ to_new.T


def test_nothing_seen_at_any_time_tells_a_turn(nominal) -> None:
    case, _ = nominal
    shown = []
    for core, points in (
        (case.core[:, 0], case.points),
        turned(case.core[:, 0], case.points, TURN),
    ):
        cores, _ = case.model.trajectory(core, 149)
        rows = case.model.rows(cores, points[:, None], np.arange(150))
        shown.append([rows.shown, rows.common])
    np.testing.assert_allclose(shown[1][0], shown[0][0], atol=1e-6)
    np.testing.assert_allclose(shown[1][1], shown[0][1], atol=1e-9)


def test_the_gauge_is_the_derivative_of_a_turn(nominal) -> None:
    case, _ = nominal
    core, points, step = case.core[:, 40], case.points, 1e-5
    gauge = case.model.gauge(core, points)
    for axis in range(3):
        ends = [turned(core, points, sign * step * np.eye(3)[axis]) for sign in (1, -1)]
        cores = case.model.difference(ends[0][0], ends[1][0])
        both = joined(cores, ends[0][1] - ends[1][1]) / (2 * step)
        np.testing.assert_allclose(gauge[..., axis], both, atol=1e-8)


@pytest.fixture(scope="module")
def begun(experiment):
    """Two runs from the first image on, their axes known to 5 deg."""
    case = experiment(2, 120, 15, guess=0.7)
    core, by_parameters = case.model.start(case.parameters)
    covariance = np.zeros((2, 50, 50))
    covariance[:, :17, :17] = (
        by_parameters @ case.covariance[:, :14, :14] @ np.swapaxes(by_parameters, -1, -2)
    )
    covariance[:, :3, :3] += np.radians(5.0) ** 2 * np.eye(3)
    return case, Belief(core, np.zeros((2, 11, 3)), covariance)


def filtered(case, belief, untold):
    return landmark_filter(
        *(case.model, belief, np.zeros((2, 11), dtype=bool), np.full(2, -1), case.observed),
        *(UpdateSettings(), Annealing(100.0, 20.0)),
        untold=untold,
    )


def test_no_more_is_claimed_of_the_axes_than_was_known(begun) -> None:
    case, belief = begun
    known = information(case.model, belief)
    as_it_is, mended = filtered(case, belief, None), filtered(case, belief, known)
    np.testing.assert_array_equal(mended.state, as_it_is.state)
    state = mended.state[:, -1]
    gauge = case.model.gauge(state[:, :18], state[:, 18:].reshape(2, 11, 3))
    for found, most in ((as_it_is, np.inf), (mended, 1.0 + 1e-6)):
        claimed = np.swapaxes(gauge, 1, 2) @ np.linalg.solve(found.covariance[:, -1], gauge)
        ratio = np.linalg.eigvals(np.linalg.solve(known, claimed)).real.max(-1)
        assert (ratio < most).all()
        if found is as_it_is:
            assert (ratio > 10.0).all()
            np.testing.assert_allclose(mended.counts["claimed"][:, -1], ratio, rtol=1e-6)
    assert (mended.sigma[:, -1, :3] > np.radians(4.0)).all()
    assert (mended.sigma >= as_it_is.sigma * (1 - 1e-12)).all()


def test_what_does_not_turn_keeps_its_sigma(begun) -> None:
    """The distance of two points, and the position, are as well known as before."""
    case, belief = begun
    as_it_is = filtered(case, belief, None)
    mended = filtered(case, belief, information(case.model, belief))
    np.testing.assert_allclose(mended.sigma[:, -1, 6:12], as_it_is.sigma[:, -1, 6:12], rtol=1e-6)
    points = mended.state[:, -1, 18:].reshape(2, 11, 3)
    along = points[:, 3] - points[:, 7]
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    rows = np.zeros((2, 50))
    rows[:, 17 + 9 : 17 + 12], rows[:, 17 + 21 : 17 + 24] = along, -along
    of_both = [
        np.einsum("ri,rij,rj->r", rows, found.covariance[:, -1], rows)
        for found in (as_it_is, mended)
    ]
    np.testing.assert_allclose(*of_both, rtol=1e-4)


def test_axes_that_are_held_have_no_gauge(begun) -> None:
    case, belief = begun
    exact = belief.covariance.copy()
    exact[:, :3] = exact[:, :, :3] = 0.0
    assert information(case.model, belief._replace(covariance=exact)) is None


def test_what_claims_less_stays_as_it_is(begun) -> None:
    case, belief = begun
    nowhere = np.zeros((2, 11), dtype=bool)
    little = 0.1 * information(case.model, belief)
    told, ratio = honest(case.model, belief, nowhere, 100.0 * little)
    np.testing.assert_allclose(told, belief.covariance, atol=1e-15)
    np.testing.assert_allclose(ratio, 0.1, rtol=1e-9)
