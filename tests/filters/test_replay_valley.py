"""Covariances of replays whose cost bends, beside the exact floor of the cost."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from debrisest.filters.replay.gauss_newton import Held, gauss_newton
from debrisest.filters.replay.measured_arc import measured_arc
from debrisest.filters.replay.replay import replay, smooth
from debrisest.filters.replay.valley import with_bends
from tests.filters.constants import constants

RUNS, EPOCHS, SIGMA = 60, 30, 0.02
TILT, SLOPE = 0, 1
PRIOR = np.array([0.3, 0.7])


def model_of(shown, derivative, bending=(SLOPE,)):
    """Two constants, measured through a function of both at every epoch."""

    def rows(states, sensitivity, first, epochs):
        return shown(states)[..., None], derivative(states)[..., None, :]

    return constants(rows, np.array([SIGMA]), ("tilt", "slope"), bending=bending)


def product(bending=(SLOPE,)):
    """Only the product of both is seen: the tilt of a spin, and a slope of the inertia."""
    return model_of(lambda x: x[..., TILT] * x[..., SLOPE], lambda x: x[..., ::-1], bending)


def line():
    weights = np.array([1.0, 2.0])
    return model_of(lambda x: x @ weights, lambda x: np.broadcast_to(weights, x.shape))


def found_of(model, seed=0):
    """Truths, priors, measurements and estimates of spins: no tilt, slopes of 0.3 to 0.8."""
    rng = np.random.default_rng(seed)
    truth = np.stack([np.zeros(RUNS), rng.uniform(0.3, 0.8, RUNS)], -1)
    prior = truth + PRIOR * rng.normal(size=(RUNS, 2))
    shown = model.rows(truth[:, None], None, 0, None)[0]
    measured = shown + SIGMA * rng.normal(size=(RUNS, EPOCHS, 1))
    covariance = np.broadcast_to(np.diag(PRIOR**2), (RUNS, 2, 2))
    known = model, prior, covariance, measured
    found = replay(*known)
    return truth, known, found, with_bends(*known, found)


def floor(known, run, slope):
    """Least cost over the tilt, by another minimiser: of a product it has one minimum."""
    _, prior, _, measured = known

    def cost(tilt):
        offset = (np.array([tilt, slope]) - prior[run]) / PRIOR
        return offset @ offset + np.sum(((measured[run] - tilt * slope) / SIGMA) ** 2)

    return minimize_scalar(cost, bounds=(-3.0, 3.0), method="bounded").fun


def test_what_does_not_bend_is_left_alone() -> None:
    _, _, found, told = found_of(line())
    np.testing.assert_allclose(told.covariance, found.covariance, rtol=1e-6)
    np.testing.assert_allclose(told.sigma, found.sigma, rtol=1e-6)


def test_sigmas_of_a_bent_valley_hold() -> None:
    """By its curvature alone the slope is sure to be zero where the tilt has been taken for not."""
    truth, _, found, told = found_of(product())
    far = [
        np.abs(one.state[:, -1] - truth)[:, SLOPE] / one.sigma[:, -1, SLOPE]
        for one in (found, told)
    ]
    assert np.mean(far[0] > 5.0) > 0.1, "a filter that does not look is wrong, and sure of itself"
    assert far[1].max() < 4.0


def test_the_stated_parabola_is_below_the_floor() -> None:
    _, known, found, told = found_of(product())
    for run in range(20):
        at, sigma = found.state[run, -1, SLOPE], told.sigma[run, -1, SLOPE]
        rise = [floor(known, run, at + way * sigma) - floor(known, run, at) for way in (-3.5, 3.5)]
        assert min(rise) > 0.6 * 9.0


def test_an_error_that_does_not_bend_is_not_looked_at() -> None:
    _, _, found, told = found_of(product(bending=()))
    assert told is found


@pytest.mark.parametrize("error", [TILT, SLOPE])
def test_all_but_what_is_held_is_at_its_best(error: int) -> None:
    """Of a plane through measurements, by the textbook formula of conditional means."""
    _, known, found, _ = found_of(line())
    model, prior = known[:2]
    arc = measured_arc(*known)
    best, spread = found.state[:, -1], found.covariance[:, -1]
    value = np.linspace(-2.0, 2.0, RUNS)
    held = Held(np.full(RUNS, error), best, value, np.full(RUNS, 1e-6))
    at = gauss_newton(model, arc, prior, EPOCHS - 1, 5, 1e-9, held=held).at
    way = spread[:, :, error] / spread[:, error, error, None]
    np.testing.assert_allclose(at.state, best + value[:, None] * way, atol=1e-6)


def test_what_is_held_is_put_back_alone() -> None:
    _, known, found, _ = found_of(line())
    model, best = known[0], found.state[:, -1]
    held = Held(np.full(RUNS, SLOPE), best, np.linspace(-1.0, 1.0, RUNS), np.full(RUNS, 1e-6))
    kept = held.kept(model, best + np.array([0.1, 0.2]))
    np.testing.assert_allclose(kept, best + np.stack([np.full(RUNS, 0.1), held.value], -1))


def test_where_nothing_more_can_be_moved_it_is_left_to_be_sought() -> None:
    """A state that cannot follow is not moved half the way."""
    _, known, found, _ = found_of(line())
    model, best = known[0], found.state[:, -1]
    stuck = model._replace(retract=lambda state, error: state + np.clip(error, -0.1, 0.1))
    held = Held(np.full(RUNS, SLOPE), best, np.full(RUNS, 0.5), np.full(RUNS, 1e-6))
    np.testing.assert_array_equal(held.kept(stuck, best), best)


def test_all_epochs_of_a_smoother_have_the_spread_of_one_motion() -> None:
    """Constants are as uncertain at every epoch, and the floor of their cost is one."""
    model, prior, covariance, measured = found_of(product())[1]
    found = replay(model, prior, covariance, measured)
    final = smooth(model, prior, covariance, measured, found, keep=[3, EPOCHS - 1])
    told = with_bends(model, prior, covariance, measured, final, smoothed=True)
    filtered = with_bends(model, prior, covariance, measured, found)
    np.testing.assert_allclose(told.covariance[:, 0], told.covariance[:, 1], rtol=1e-9)
    np.testing.assert_allclose(told.sigma[:, 2], told.sigma[:, -1], rtol=1e-9)
    wide = filtered.sigma[:, -1, SLOPE] > 1.5 * found.sigma[:, -1, SLOPE]
    assert wide.any()
    assert np.all(told.sigma[wide, -1, SLOPE] > 1.3 * final.sigma[wide, -1, SLOPE])


def test_where_all_runs_are_lost_nothing_is_followed():
    _, (model, *rest), found, _ = found_of(product())
    lost = found._replace(state=np.full_like(found.state, np.nan))

    def never(*_):
        raise AssertionError("a batch without runs was followed")

    after = with_bends(model._replace(rewind=never), *rest, lost)
    np.testing.assert_array_equal(after.sigma, lost.sigma)
    np.testing.assert_array_equal(after.covariance, lost.covariance)
