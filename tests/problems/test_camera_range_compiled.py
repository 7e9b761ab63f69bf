"""The compiled rotation in orbit against the numpy code, whose oracles are in tests/dynamics."""

from types import SimpleNamespace

import numpy as np
import pytest

from debrisest import compiled
from debrisest.problems.camera_range import model

pytest.importorskip("numba")


@pytest.mark.parametrize("gravity", [True, False])
@pytest.mark.parametrize("count", [1, 4])
def test_rotation_is_the_same(monkeypatch: pytest.MonkeyPatch, gravity: bool, count: int) -> None:
    draws = np.random.default_rng(count)
    core = np.zeros((3, model.LOG_INERTIA.stop))
    core[:, model.Q] = draws.normal(size=(3, 4))
    core[:, model.Q] /= np.linalg.norm(core[:, model.Q], axis=-1, keepdims=True)
    core[:, model.RATE] = 0.02 * draws.normal(size=(3, 3))
    core[:, model.LOG_INERTIA] = 0.3 * draws.normal(size=(3, 5))
    known = SimpleNamespace(mean_motion=1e-3, step=1.0, gravity_gradient=gravity)
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        found.append(model._rotation(known, core, 200, count))
    for fast, slow in zip(*found):
        np.testing.assert_allclose(fast, slow, atol=1e-12 * np.abs(slow).max())
