"""The compiled loops of the landmark cost and filter against the numpy code, tested elsewhere."""

import numpy as np
import pytest

from debrisest import compiled
from debrisest.filters.landmarks.cost import Prior, Unknowns, cost

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


@pytest.mark.parametrize("name", CASES)
def test_rows_and_cost_are_the_same(experiment, monkeypatch, name: str) -> None:
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
    for robust in (True, False):
        same(*both(monkeypatch, lambda: cost(case.model, observed, prior, at, frames, robust)))
