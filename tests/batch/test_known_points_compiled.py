"""Compiled loops on known points against the numpy code, whose oracles are in the other tests."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.batch import acceptance
from debrisest.batch.arc import Arc, along, displaced
from debrisest.batch.curvature import spread_of
from debrisest.batch.descent import NOTHING_ELSE, Prior, costs, covariance, descend
from debrisest.batch.local_rates import local_rates
from debrisest.batch.outliers import mean_residuals
from debrisest.batch.path import path_of
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.rigid_sets import largest_rigid_set, odd_points, pairs
from debrisest.batch.smoother import Wander, _likelihoods, smooth
from debrisest.batch.spread import shift, straight
from debrisest.batch.tracks import tracks
from debrisest.batch.windows import _fitted
from tests.batch.test_compiled import both

pytest.importorskip("numba")

TIMES = np.linspace(0.0, 300.0, 151)
NOISE = 0.05
TRUTH = Arc(
    150.0,
    np.array([0.5, 0.5, 0.5, 0.5]),
    np.array([0.08, 0.05, -0.06]),
    np.array([0.2, 0.1, 0.0, -0.1, 0.05]),
)


def seen(wrong: float, count: int = 6) -> KnownPoints:
    """Return points of a body that moves so, of which a third is not seen and some are wrong."""
    draws = np.random.default_rng(5)
    body = draws.normal(size=(count, 3))
    points = body @ np.swapaxes(quaternion.to_matrix(along(TRUTH, TIMES)[0]), -1, -2)
    points += NOISE * draws.normal(size=points.shape)
    points[draws.random(points.shape[:2]) < wrong] += 1.0
    points[draws.random(points.shape[:2]) < 0.3] = np.nan
    sigma = np.broadcast_to(NOISE * np.array([1.0, 1.0, 1.1]), points.shape)
    return KnownPoints(tracks(TIMES, points, sigma), body)


def close(fast, slow, share: float = 1e-9) -> None:
    scale = np.nanmax(np.abs(slow), initial=1e-300)
    np.testing.assert_allclose(fast, slow, atol=share * scale, rtol=0.0)


@pytest.mark.parametrize("wrong", [0.0, 0.15])
@pytest.mark.parametrize("held", [NOTHING_ELSE, Prior(np.full(5, 0.05), 1e4 * np.eye(5))])
def test_fits_of_windows_are_the_same(monkeypatch, wrong, held) -> None:
    """Of two points alone both are as far off, and rounding says which of them goes."""
    window = seen(wrong)
    start = displaced(TRUTH, np.repeat([2e-2, 1e-5, 1e-2], [3, 3, 5]))
    (fast, kept), (slow, left) = both(monkeypatch, _fitted, window, start, held)
    several = left.tracks.seen.sum(axis=1) > 1
    np.testing.assert_array_equal(kept.tracks.weight[several], left.tracks.weight[several])
    assert (left.tracks.seen.sum() < window.tracks.seen.sum()) == (wrong > 0.0)
    assert fast.settled and slow.settled
    sigma = np.sqrt(np.diag(covariance(slow.hold)))
    np.testing.assert_array_less(np.abs(shift(slow.arc, fast.arc)), 1e-4 * sigma)
    assert fast.chi2 == pytest.approx(slow.chi2, rel=1e-9)
    close(fast.hold, slow.hold, 1e-5)


@pytest.mark.parametrize("error", [0.0, 0.01])
def test_tests_are_the_same(monkeypatch, error) -> None:
    arc = displaced(TRUTH, np.full(11, error))
    fast, slow = both(monkeypatch, acceptance.tested, seen(0.0), arc)
    for one, other in zip(fast, slow):
        close(one, other, 1e-10)
    assert fast.steady == slow.steady == (error == 0.0)
    close(*both(monkeypatch, mean_residuals, seen(0.0), arc, slow.excess), 1e-12)


def test_costs_are_the_same(monkeypatch) -> None:
    errors = 1e-2 * np.random.default_rng(1).normal(size=(4, 11))
    errors[3, 6:] = 3.0
    fast, slow = both(monkeypatch, costs, seen(0.0), displaced(TRUTH, errors))
    np.testing.assert_allclose(fast, slow, rtol=1e-11)
    assert np.isinf(slow[3]) and np.isfinite(slow[:3]).all()


@pytest.mark.parametrize("bends", [True, False])
def test_paths_are_the_same(monkeypatch, bends) -> None:
    """Of ends near, whose turn is a short series, and far."""
    evidence = seen(0.0)
    few = evidence.within(TIMES < 30.0)
    found = descend(few if bends else evidence, TRUTH)
    linear = covariance(found.hold)
    spread = spread_of(few, found, linear) if bends else straight(found.arc, linear)
    assert bool(len(spread.ends.ahead.q)) == bends
    fast, slow = both(monkeypatch, path_of, found.arc, spread, TIMES)
    for one, other in zip(fast, slow):
        close(one, other, 1e-10)
    close(*both(monkeypatch, spread.covariance, found.arc), 1e-10)


def test_gates_are_the_same(monkeypatch) -> None:
    evidence, (q, rate) = seen(0.2, 8), along(TRUTH, TIMES)
    fast, slow = both(monkeypatch, evidence.gated, q, rate, 25.0)
    several = slow.tracks.seen.sum(axis=1) > 1
    np.testing.assert_array_equal(fast.tracks.weight[several], slow.tracks.weight[several])
    assert several.any() and slow.tracks.seen.sum() < evidence.tracks.seen.sum()
    fast, slow = both(monkeypatch, evidence.gated, q, rate, 1e-3)
    np.testing.assert_array_equal(fast.tracks.weight, evidence.tracks.weight)
    np.testing.assert_array_equal(slow.tracks.weight, evidence.tracks.weight)


@pytest.mark.parametrize("known", [True, False])
def test_rigid_sets_are_the_same(monkeypatch, known) -> None:
    evidence = seen(0.1)
    model = evidence.model if known else None
    fast, slow = both(monkeypatch, pairs, evidence.tracks, model)
    for one, other in zip(fast, slow):
        np.testing.assert_allclose(one, other, rtol=1e-12)
    fast, other = both(monkeypatch, odd_points, evidence.tracks, slow, NOISE)
    np.testing.assert_array_equal(fast, other)
    assert other.any()
    np.testing.assert_array_equal(*both(monkeypatch, largest_rigid_set, slow, 0.6 * NOISE))


@pytest.mark.parametrize("order", [2, 3])
def test_smoothers_are_the_same(monkeypatch, order) -> None:
    evidence = seen(0.0).within(TIMES > 40.0)
    local = local_rates(evidence.times, evidence.seen())
    intensity = np.logspace(-9.0, -3.0, 4)
    for fast, slow in zip(*both(monkeypatch, _likelihoods, evidence, local, order, intensity)):
        np.testing.assert_allclose(fast, slow, rtol=1e-8)
    between = np.sort(np.concatenate([TIMES, TIMES[1:] - 0.7]))
    fast, slow = both(monkeypatch, smooth, evidence, local, Wander(order, 1e-5, 1.1), between)
    for one, other in zip(fast, slow):
        close(one, other, 1e-8)
    assert np.isnan(slow.q[0]).all() and np.isfinite(slow.q[-1]).all()
