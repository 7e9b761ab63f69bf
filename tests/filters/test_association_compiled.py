"""The compiled association filters against the numpy code, whose oracles are in other files."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.filters.association.single import associated, jointly_associated
from debrisest.filters.association.weighing import Way, Weighing
from debrisest.filters.association.weights import Validation
from debrisest.filters.doubt import Doubt
from debrisest.filters.estimates import Estimates
from debrisest.filters.scan_model import ScanModel

pytest.importorskip("numba")

RUNS, EPOCHS, SENSORS = 40, 30, 2  # more runs than a block has
F = np.eye(4) + np.eye(4, k=2)
Q = 0.01 * np.diag([0.25, 0.25, 1.0, 1.0])
R = np.array([[0.5, 0.1], [0.1, 0.8]])
H = np.random.default_rng(1).normal(size=(SENSORS, 2, 4))
BY_DOUBT = np.random.default_rng(2).normal(size=(SENSORS, 2, 3))
RULE = Validation(detection_probability=0.9)


def points_jacobian(x: Array, _: int) -> Array:
    """Return H, but nothing where the target is far to the left."""
    return np.where(x[..., 0, None, None, None] > -6.0, H, np.nan)


MODEL = ScanModel(
    process=lambda x, _: x @ F.T + 0.01 * np.sin(x),
    process_jacobian=lambda x, _: F + 0.01 * np.cos(x)[..., None] * np.eye(4),
    process_noise=Q,
    points=lambda x, _: (H @ x[..., None, :, None])[..., 0] + 0.01 * x[..., None, :2] ** 2,
    points_jacobian=points_jacobian,
    noise=R,
    error_names=("x", "y", "u", "v"),
    doubts=(Doubt("a", 1.0), Doubt("b", 1.0), Doubt("c", 1.0)),
    doubted=lambda x, _: BY_DOUBT * np.cos(x[..., :1, None, None]),
    select=lambda _: MODEL,
)


def drawn(tracks: int, detections: int) -> tuple[Array, Array, Array]:
    """States, covariances and scans, of which some are missing; two runs have no start."""
    draws = np.random.default_rng(tracks + 10 * detections)
    state = draws.normal(size=(RUNS, tracks, 4))
    root = draws.normal(size=(RUNS, tracks, 4, 6))
    shown = (H @ state[:, None, 0, None, :, None])[..., None, :, 0]
    scans = shown + 2.0 * draws.normal(size=(RUNS, EPOCHS, SENSORS, detections, 2))
    scans[draws.random(scans.shape[:-1]) < 0.3] = np.nan
    scans[3], state[1], root[2] = np.nan, np.nan, np.nan
    if tracks > 1:
        state[4:8, 1] = np.nan
    return state, root @ np.swapaxes(root, -2, -1), scans


def both_ways(monkeypatch: pytest.MonkeyPatch, run: Callable[[], Any]) -> list[Any]:
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        with np.errstate(all="ignore"):
            found.append(run())
    return found


def require_same(loops: Estimates, plain: Estimates) -> None:
    assert (loops.status == plain.status).all()
    assert loops.counts.keys() == plain.counts.keys()
    ended = np.isfinite(plain.state).all((1, 2))
    assert 0.5 * RUNS < ended.sum() < RUNS
    parts = zip((*loops[:6], *loops.counts.values()), (*plain[:6], *plain.counts.values()))
    for fast, slow in parts:
        if len(slow) == RUNS:
            fast, slow = fast[ended], slow[ended]
        assert fast.shape == slow.shape and fast.dtype == slow.dtype
        size = np.abs(slow).max(initial=0.0)
        np.testing.assert_allclose(fast, slow, rtol=0.0, atol=1e-11 * size)


@pytest.mark.parametrize(
    "keys",
    [
        {},
        {"method": "nearest"},
        {"relinearise": 0},
        {"relinearise": 7, "restless": True},
        {"truth": np.random.default_rng(3).normal(size=(RUNS, EPOCHS, 4))},
    ],
    ids=["estimate", "nearest", "start", "restless", "truth"],
)
@pytest.mark.parametrize("detections", [1, 5])
def test_a_filter_of_one_target_is_the_same(
    monkeypatch: pytest.MonkeyPatch, keys: dict[str, Any], detections: int
) -> None:
    state, covariance, scans = drawn(1, detections)
    given = MODEL, state[:, 0], covariance[:, 0], scans, RULE
    require_same(*both_ways(monkeypatch, lambda: associated(*given, keep=[3], **keys)))


@pytest.mark.parametrize("detections", [1, 4])
def test_a_filter_of_three_tracks_is_the_same(
    monkeypatch: pytest.MonkeyPatch, detections: int
) -> None:
    given = MODEL, *drawn(3, detections), RULE
    require_same(*both_ways(monkeypatch, lambda: jointly_associated(*given, keep=[3])))


@pytest.mark.parametrize("way", ["nearest", "probabilistic", "joint"])
@pytest.mark.parametrize("certain", [True, False])
def test_detections_weigh_the_same(way: Way, certain: bool) -> None:
    """Also where a target is always detected, so that absence weighs nothing."""
    from debrisest.filters.association.weight_loops import weigh

    sure = Validation(detection_probability=1.0, gate_probability=1.0)
    weighing = Weighing(way, sure if certain else RULE, 2)
    distance = np.random.default_rng(4).chisquare(4, size=(3, 5, 50))
    distance[distance > 6.0], distance[..., 0] = np.inf, np.inf
    found = np.empty(distance.shape)
    weigh(*weighing.numbers, distance, found, np.empty((12, 8)))
    with np.errstate(all="ignore"):
        plain = weighing(np.moveaxis(distance, -1, 0)[:, :, None])
    np.testing.assert_allclose(found, np.moveaxis(plain[:, :, 0], 0, -1), rtol=1e-12, atol=1e-300)
