"""The compiled loops of unknown points against the numpy code, whose oracles are beside."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from debrisest import compiled
from debrisest.attitude import quaternion
from debrisest.batch.align_clouds import align_clouds
from debrisest.batch.arc import Arc, along, course, displaced
from debrisest.batch.descent import descend
from debrisest.batch.free_points import FreePoints
from debrisest.batch.tracks import tracks
from debrisest.dynamics.log_inertia import log_ratios

pytest.importorskip("numba")

TIMES = np.linspace(0.0, 300.0, 200)
TRUTH = Arc(
    150.0,
    np.array([1.0, 0.0, 0.0, 0.0]),
    np.radians([7.2, 5.5, -1.6]),
    log_ratios(np.diag([0.62, 0.71, 0.35])),
)


@pytest.fixture
def both(monkeypatch: pytest.MonkeyPatch) -> Callable[..., list[Any]]:
    """Return what a call gives with numba and without."""

    def call(function: Callable[[], Any]) -> list[Any]:
        found = []
        for fast in (True, False):
            monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
            found.append(function())
        return found

    return call


def drawn(hidden: float) -> FreePoints:
    """Eight points with an error, of which a share is not seen, and some far off."""
    draws = np.random.default_rng(3)
    model = draws.normal(size=(8, 3))
    points = model @ np.swapaxes(quaternion.to_matrix(along(TRUTH, TIMES)[0]), -1, -2)
    points += draws.normal(size=(200, 1, 3)) + 0.02 * draws.normal(size=points.shape)
    points[draws.random((200, 8)) < 0.02] += 1.0
    points[draws.random((200, 8)) < hidden] = np.nan
    return FreePoints(tracks(TIMES, points, draws.uniform(0.02, 0.04, (200, 8))), model)


def require_same(fast: Any, slow: Any, tolerance: float = 1e-10) -> None:
    for mine, other in zip(fast, slow):
        np.testing.assert_allclose(mine, other, rtol=0.0, atol=tolerance * np.nanmax(np.abs(other)))


@pytest.mark.parametrize("hidden", [0.1, 0.6])
def test_what_points_tell_is_the_same(both: Callable[..., Any], hidden: float) -> None:
    error = np.random.default_rng(1).normal(size=11) * 1e-2
    arc = displaced(TRUTH, np.append(error[:3], 0.01 * error[3:]))
    q, rate = along(arc, TIMES)
    motion = course(arc, TIMES)
    fresh = drawn(hidden)
    for ask in (
        lambda: FreePoints(*vars(fresh).values()).normal(motion),
        lambda: fresh.settled(q).told(q, rate),
        lambda: fresh.settled(q).told(q[5:9], rate, slice(5, 9)),
        lambda: (fresh.chi2(q, rate), fresh.settled(q).model, fresh.squares(q, rate)),
    ):
        require_same(*both(ask))


def test_a_descent_ends_at_the_same_place(both: Callable[..., Any]) -> None:
    error = np.repeat([1e-3, 1e-5, 0.02], [3, 3, 5]) * np.random.default_rng(2).normal(size=11)
    fast, slow = both(lambda: descend(drawn(0.3), displaced(TRUTH, error)))
    require_same((fast.chi2, fast.arc.rate), (slow.chi2, slow.arc.rate), 1e-8)
    require_same((fast.hold,), (slow.hold,), 1e-6)
    assert fast.settled and slow.settled


@pytest.mark.parametrize("hidden", [0.1, 0.6])
def test_clouds_are_laid_over_each_other_alike(both: Callable[..., Any], hidden: float) -> None:
    fast, slow = both(lambda: align_clouds(drawn(hidden).tracks))
    require_same((fast.model,), (slow.model,), 1e-9)
    np.testing.assert_array_equal(fast.tracks.weight, slow.tracks.weight)


def test_the_nearest_rotation_is_the_same() -> None:
    """Of any matrix, also of those of rank two and of a reflection."""
    from debrisest.attitude.nearest_loops import nearest

    matrix = np.random.default_rng(5).normal(size=(500, 3, 3))
    matrix[:100, 2] = matrix[:100, 0]
    matrix[100:120] = -np.diag([1.0, 2.0, 3.0])
    found = [nearest(one, np.empty((4, 4)), np.empty((4, 4))) for one in matrix]
    turn = quaternion.angle_between(np.array(found), quaternion.nearest(matrix))
    assert np.array(found)[:, 0].min() >= 0.0
    assert np.quantile(turn, 0.9) < 1e-12 and turn.max() < 1e-8
