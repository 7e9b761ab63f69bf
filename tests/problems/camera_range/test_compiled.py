"""The compiled loops of the landmark cost and filter against the numpy code, tested elsewhere."""

import numpy as np
import pytest

from debrisest import compiled
from debrisest.filters.landmarks.cost import Prior, Unknowns, cost
from debrisest.filters.landmarks.update import Belief, UpdateSettings, update

pytest.importorskip("numba")

CASES = {
    "known": {},
    "implied": {"attitude": "implied"},
    "bias": {"range_to": "bias", "camera_bias": True},
    "landmark": {"range_to": "landmark"},
    "noise": {"attitude_sigma": 1e-3},
    "false": {"false_share": 0.1},
}


def both(monkeypatch: pytest.MonkeyPatch, call) -> list:
    """Return what the loops give, and what numpy does."""
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        found.append(call())
    return found


def same(fast, slow) -> None:
    for one, other in zip(fast, slow):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * np.abs(other).max(initial=0.0))


@pytest.mark.parametrize("robust", [True, False])
@pytest.mark.parametrize("name", CASES)
def test_rows_and_cost_are_the_same(experiment, monkeypatch, name: str, robust: bool) -> None:
    """Some landmarks have no place yet, and many frames do not show one."""
    case = experiment(3, 70, 1, **CASES[name])
    observed = case.observed._replace(seen=case.observed.seen.copy())
    observed.seen[:, 10:40, 4], observed.common_seen[1, 5:9] = False, False
    placed = np.ones(case.points.shape[:2], dtype=np.bool_)
    placed[1, 3:6] = False
    nearby = case.model.parameters(case.core[:, 0]) + 1e-3
    at = Unknowns(nearby, case.points + 0.02, placed)
    prior = Prior(at.vector + 0.1, np.linalg.inv(case.covariance))
    frames = np.arange(1, 70, 2)
    rows = case.core, case.points[:, None], np.arange(70)
    same(*both(monkeypatch, lambda: case.model.rows(*rows)))
    same(*both(monkeypatch, lambda: cost(case.model, observed, prior, at, frames, robust)))


@pytest.mark.parametrize("gate", [1e-3, None])
@pytest.mark.parametrize("name", CASES)
def test_updates_are_the_same(experiment, monkeypatch, name: str, gate: float | None) -> None:
    """A landmark is far off, one is not there, and one run has seen nothing."""
    case = experiment(4, 12, 2, **CASES[name])
    model, draws = case.model, np.random.default_rng(0)
    observed = case.observed.at(slice(None), 11)
    observed.shown[1, 3] += 50.0
    observed.seen[:, 5], observed.common_seen[2] = False, False
    observed.seen[3], observed.common_seen[3] = False, False
    n_e = model.errors + case.points[0].size
    size = np.r_[np.full(3, 1e-3), np.full(3, 1e-4), np.full(n_e - 6, 0.02)]
    root = size[:, None] * draws.normal(size=(4, n_e, n_e)) / np.sqrt(n_e)
    prior = Belief(case.core[:, 11], case.points + 0.01, root @ np.swapaxes(root, -1, -2))
    settings = UpdateSettings(iterations=3, tolerance=1e-3, false_alarm=gate)
    (fast, counted), (slow, expected) = both(
        monkeypatch, lambda: update(model, prior, observed, 11, settings, 2.0)
    )
    np.testing.assert_allclose(fast.core, slow.core, rtol=0, atol=1e-11)
    np.testing.assert_allclose(fast.points, slow.points, rtol=0, atol=1e-11)
    sigma = np.sqrt(np.diagonal(slow.covariance, 0, -2, -1))
    apart = (fast.covariance - slow.covariance) / (sigma[:, :, None] * sigma[:, None])
    assert np.abs(apart).max() < 1e-8
    np.testing.assert_allclose(counted.nis, expected.nis, rtol=1e-9)
    for one, other in zip(counted[1:], expected[1:]):
        np.testing.assert_array_equal(one, other)
    assert (expected.rejected[1] >= model.rows_each) == (gate is not None)
