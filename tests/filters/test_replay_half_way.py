"""The joint error of a motion whose acceleration is a product of two numbers, half way."""

import numpy as np
import pytest

from debrisest.filters.replay.half_way import half_way, moved
from debrisest.filters.replay.replay import replay, smooth
from debrisest.filters.replay.valley import with_bends
from debrisest.filters.replay_model import ReplayModel
from tests.filters.chi_square import nees, probable
from tests.filters.constants import constants

RUNS, EPOCHS = 400, 21
PRIOR = np.array([10.0, 10.0, 0.07, 0.07])


def course(state, times):
    """Position, velocity and both numbers (run, time, 4), ``times`` after a state."""
    x, v, a, b = np.moveaxis(state[:, None], -1, 0)
    constant = np.ones_like(x * times)
    moving = x + v * times + 0.5 * a * b * times**2, v + a * b * times
    return np.stack([*moving, a * constant, b * constant], -1)


def derivative(state, times):
    _, _, a, b = np.moveaxis(state[:, None], -1, 0)
    result = np.zeros((len(state), len(times), 4, 4))
    result[..., :, :] = np.eye(4)
    result[..., 0, 1] = times
    for column, other in ((2, b), (3, a)):
        result[..., 0, column] = 0.5 * other * times**2
        result[..., 1, column] = other * times
    return result


def accelerated() -> ReplayModel:
    """The position is measured; of the two numbers it tells the product, and the prior the rest."""

    def trajectory(state, first, last):
        step = 1 if last >= first else -1
        times = np.arange(0.0, last - first + step, step)
        return course(state, times), derivative(state, times)

    def rows(states, sensitivity, first, epochs):
        return states[..., :1], sensitivity[..., :1, :]

    return constants(rows, np.ones(1), ("x", "v", "a", "b"))._replace(
        trajectory=trajectory,
        transition=lambda sensitivity, first, last: sensitivity,
        rewind=lambda state, epoch: trajectory(state, epoch, 0)[0][:, -1],
    )


def data(seed):
    """True motions drawn from the prior, and all that is known of them."""
    rng = np.random.default_rng(seed)
    prior = np.tile([0.0, 0.0, 1.0, 1.0], (RUNS, 1))
    start = prior + PRIOR * rng.normal(size=(RUNS, 4))
    truth = course(start, np.arange(float(EPOCHS)))
    measured = truth[..., :1] + rng.normal(size=(RUNS, EPOCHS, 1))
    return truth, (accelerated(), prior, np.tile(np.diag(PRIOR**2), (RUNS, 1, 1)), measured)


@pytest.mark.parametrize("seed", [0, 1])
def test_the_joint_error_is_normal_half_way_and_not_at_the_end(seed: int) -> None:
    """Truths are draws of the posterior, by Bayes: their errors are what it says, if it is normal.

    By the prior the product is off from its line by 5e-3 at one sigma: 1.0 at the end by the errors
    there, which it shows as well as one measurement does, and a quarter by those half way.
    """
    truth, known = data(seed)
    found = replay(*known)
    told = with_bends(*known, found, truth=truth)
    assert not probable(nees(found, truth[:, [-1] * EPOCHS], -1), 4 * RUNS)
    assert probable(told.counts["square_half_way"][:, -1].sum(), 4 * RUNS)


def test_no_estimate_depends_on_the_truth() -> None:
    truth, known = data(0)
    found = replay(*known)
    told = with_bends(*known, found, truth=truth)
    for before, after in zip(found[:3], told[:3]):
        np.testing.assert_array_equal(before, after)
    assert np.isnan(told.counts["square_half_way"][:, :-1]).all(), "kept at the end alone"


def test_it_lies_between_the_first_measurement_and_the_epoch() -> None:
    measured = np.full((2, 12, 3), np.nan)
    assert half_way(measured, 0) == 0
    measured[1, 4, 2] = 1.0
    assert [half_way(measured, last) for last in (2, 4, 6, 11)] == [2, 4, 5, 7]


def test_errors_are_moved_as_the_motion_moves_them() -> None:
    """Covariances beside those of motions that start a little off."""
    rng = np.random.default_rng(3)
    root = 1e-4 * rng.normal(size=(1, 4, 4))
    state = np.array([[1.0, 2.0, 0.5, 1.5]])
    at, spread = moved(accelerated(), state, root @ np.swapaxes(root, -1, -2), 9, 3)
    back = np.array([-6.0])
    up, down = (
        np.stack([course(state + way * root[..., i], back)[:, 0] for i in range(4)], -1)
        for way in (1.0, -1.0)
    )
    half = 0.5 * (up - down)
    np.testing.assert_allclose(at, course(state, back)[:, 0], rtol=1e-12)
    np.testing.assert_allclose(spread, half @ np.swapaxes(half, -1, -2), rtol=1e-5)


def test_a_smoothed_motion_has_one_error() -> None:
    truth, known = data(2)
    final = smooth(*known, replay(*known), keep=[2, 9])
    square = with_bends(*known, final, smoothed=True, truth=truth).counts["square_half_way"]
    np.testing.assert_array_equal(np.isfinite(square).all(0).nonzero()[0], [2, 9, EPOCHS - 1])
    np.testing.assert_array_equal(square[:, 2], square[:, -1])
