"""The compiled rotation in orbit against the numpy code, whose oracles are in tests/dynamics."""

from types import SimpleNamespace

import numpy as np
import pytest

from debrisest import compiled
from debrisest.dynamics import log_inertia
from debrisest.problems.camera_range import course, model, redundant_model

pytest.importorskip("numba")
log_inertia_loops = pytest.importorskip("debrisest.dynamics.log_inertia_loops")


@pytest.mark.parametrize("size", [0.0, 1e-6, 0.3, 3.0])
def test_inertia_and_its_derivative_are_the_same(size: float) -> None:
    """Also of a sphere, and of bodies with two equal moments."""
    ratios = size * np.random.default_rng(1).normal(size=(5, 5))
    ratios[3:, 2:] = 0.0
    ratios[4, 0] = 0.0
    for fast, slow in zip(
        log_inertia_loops.with_derivative(ratios), log_inertia.with_derivative(ratios)
    ):
        np.testing.assert_allclose(fast, slow, rtol=0, atol=1e-12 * np.abs(slow).max())


def test_cores_are_moved_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    draws = np.random.default_rng(2)
    core, error = draws.normal(size=(4, 19)), draws.normal(size=(4, 18))
    core[:, model.Q] /= np.linalg.norm(core[:, model.Q], axis=-1, keepdims=True)
    error[1:3, :3] *= [[0.0], [1e-9]]
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        found.append(model.retract(core, error))
    np.testing.assert_allclose(*found, rtol=0, atol=1e-14)


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
        found.append(course.rotation(known, core, 200, count))
    for fast, slow in zip(*found):
        np.testing.assert_allclose(fast, slow, atol=1e-12 * np.abs(slow).max())


def test_sigma_points_of_the_redundant_model_move_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """Some share their core with the first one, and a camera stands below the orbit."""
    draws = np.random.default_rng(4)
    state = np.zeros((3, 7, redundant_model.CORE + 24))
    state[..., :7] = draws.normal(size=(3, 7, 7))
    state[..., redundant_model.RATE] *= 0.02
    state[..., redundant_model.POSITION] = draws.normal([5.0, 17.0, -6.0], size=(3, 7, 3))
    state[..., redundant_model.VELOCITY] = 0.01 * draws.normal(size=(3, 7, 3))
    state[..., redundant_model.INERTIA] = [135.0, 208.0, 260.0, 5.0, -3.0, 8.0]
    state[:, 3:, : redundant_model.CORE] = state[:, :1, : redundant_model.CORE]
    state[..., redundant_model.CORE :] = draws.normal(size=(3, 7, 24))
    known = redundant_model.CameraGeometry(points=4, mean_motion=1e-3, step=5.0, focal_px=1000.0)
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        found.append(redundant_model.process(known, state))
    np.testing.assert_allclose(*found, atol=1e-12 * np.abs(found[1]).max())
