"""The compiled model of a debris orbit against the numpy code, whose oracles are beside."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from debrisest import compiled

pytest.importorskip("numba")


@pytest.mark.parametrize("keys", [{"attitude_bias": True}, {"tracks": "all"}, {}])
def test_motion_and_points_are_the_same(
    monkeypatch: pytest.MonkeyPatch, two_observers: Callable[..., Any], keys: dict[str, Any]
) -> None:
    """Some see the debris behind them, which is not used, and biases are large or nothing."""
    monkeypatch.setattr(compiled, "available", lambda: True)
    scene = two_observers(4, bias_mrad=3.0, companions_km=10.0 if "tracks" in keys else 0.0)
    model, state, _, _ = scene.given(scene.problem(**keys))
    draws = np.random.default_rng(1)
    state = state.reshape(4, -1, state.shape[-1]).copy()
    state[..., 6:] = 0.3 * draws.normal(size=state[..., 6:].shape)
    state[0, ..., 6:] = 0.0
    observer = scene.data["observer_position"]
    state[1, 0, :3] = 2.0 * observer[1, 3, 0] - state[1, 0, :3]
    plain = model._replace(both=None, all_seen=None)
    for k in (3, 200):
        for fast, slow in zip(model.moved(state, k), plain.moved(state, k)):
            np.testing.assert_allclose(fast, slow, rtol=1e-12, atol=1e-12)
        found, wanted = model.seen(state, k), plain.seen(state, k)
        behind = np.isnan(wanted[0]).all(-1)
        assert behind[1, 0].all() and behind.mean() < 0.5
        for fast, slow, there in zip(found, wanted, (~behind, ~behind, ~behind[:, 0])):
            size = np.abs(slow[there]).max()
            np.testing.assert_allclose(fast[there], slow[there], rtol=0.0, atol=1e-12 * size)
        assert np.isnan(found[0][behind]).all() and np.isnan(found[1][behind]).any((-2, -1)).all()
