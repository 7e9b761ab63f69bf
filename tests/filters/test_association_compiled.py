"""The compiled update by one sensor against the numpy code, whose oracles are in other files."""

from functools import partial

import numpy as np
import pytest

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.filters.association.evidence import Beside
from debrisest.filters.association.joint import joint
from debrisest.filters.association.restless import Bank
from debrisest.filters.association.sensor import Given, updated
from debrisest.filters.association.update import Scan, Tracks, Weigh
from debrisest.filters.association.weights import Validation, nearest, probabilistic

pytest.importorskip("numba")

RUNS, N, DOUBTS = 60, 6, 4
NOISE, GATE = np.array([[0.5, 0.1], [0.1, 0.8]]), 9.21


def drawn(tracks: int, detections: int, weigh: Weigh) -> Given:
    draws = np.random.default_rng(tracks + 10 * detections)

    def positive(*axes: int) -> Array:
        root = draws.normal(size=(*axes, N, N + 2)) * 10.0 ** draws.uniform(-0.5, 0.5, size=(N, 1))
        return root @ np.swapaxes(root, -2, -1)

    state, bank = draws.normal(size=(RUNS, tracks, N)), positive(RUNS, 2)
    derivative = draws.normal(size=(RUNS, tracks, 1, 2, N))
    innovation = draws.normal(size=(RUNS, tracks, 1, detections, 2)) * 4.0
    innovation[draws.random(innovation.shape[:-1]) < 0.3] = np.nan
    innovation[0], innovation[1] = np.nan, 1e6
    derivative[2] = np.nan
    pull, apart = draws.normal(size=(RUNS, N, DOUBTS)), draws.normal(size=(RUNS, 2, N))
    covariance = positive(RUNS, tracks)
    covariance[3] = np.nan
    doubted = draws.normal(size=(RUNS, 1, 2, DOUBTS))
    beside = Beside(pull, Bank(apart, bank))
    target, scan = Tracks(state, covariance), Scan(innovation, derivative)
    return Given(target, beside, scan, doubted, NOISE, GATE, weigh)


def of_two_tracks(distance: Array) -> Array:
    return np.swapaxes(joint(np.swapaxes(distance, 1, 2), Validation(), 2), 1, 2)


def leaves(value: object) -> list[Array]:
    if not isinstance(value, tuple):
        return [np.asarray(value)]
    return [leaf for part in value for leaf in leaves(part)]


@pytest.mark.parametrize("weigh", ["probabilistic", "nearest", "joint"])
@pytest.mark.parametrize("detections", [1, 7])
def test_an_update_is_the_same(
    monkeypatch: pytest.MonkeyPatch, weigh: str, detections: int
) -> None:
    ways = {"nearest": nearest, "joint": of_two_tracks}
    way = ways.get(weigh, partial(probabilistic, validation=Validation(), d=2))
    given = drawn(2 if weigh == "joint" else 1, detections, way)
    before = [part.copy() for part in leaves(given[:4])]
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        with np.errstate(all="ignore"):
            found.append(leaves(updated(given)))
    assert all(np.array_equal(a, b, equal_nan=True) for a, b in zip(before, leaves(given[:4])))
    assert len(found[0]) == len(found[1]) == 13
    for loops, plain in zip(*found):
        assert loops.shape == plain.shape and loops.dtype == plain.dtype
        assert np.array_equal(np.isfinite(loops), np.isfinite(plain))
        slow, fast = (np.where(np.isfinite(one), one, 0.0) for one in (plain, loops))
        slow, fast = slow.reshape(RUNS, -1), fast.reshape(RUNS, -1)
        assert (np.abs(fast - slow) <= 1e-12 * np.abs(slow).max(1, keepdims=True)).all()
