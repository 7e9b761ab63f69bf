"""The compiled rotation in orbit against the numpy code, whose oracles are in tests/dynamics."""

from types import SimpleNamespace

import numpy as np
import pytest

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.dynamics import log_inertia
from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
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


def _problem(points: int = 4) -> tuple[redundant_model.CameraGeometry, Array, Array]:
    """States below and above the orbit, and triangular roots of covariances."""
    draws = np.random.default_rng(4)
    size = redundant_model.CORE + 6 * points
    state = draws.normal(size=(3, size))
    state[:, redundant_model.Q] /= np.linalg.norm(state[:, redundant_model.Q], axis=-1)[:, None]
    state[:, redundant_model.RATE] *= 0.02
    state[:, redundant_model.POSITION] += [[5.0, 17.0, -6.0], [-5.0, 17.0, 6.0], [3.0, -17.0, 2.0]]
    state[:, redundant_model.VELOCITY] *= 0.01
    state[:, redundant_model.INERTIA] = [135.0, 208.0, 260.0, 5.0, -3.0, 8.0]
    known = redundant_model.CameraGeometry(points, mean_motion=1e-3, step=5.0, focal_px=1000.0)
    state[:, known.camera_points][:, 2::3] += 20.0
    sigma = np.repeat([0.01, 1e-3, 0.3, 0.01, 1.0, 0.1], [4, 3, 3, 3, 6, 6 * points])
    root = sigma[:, None] * np.tril(0.2 * draws.normal(size=(3, size, size)) + np.eye(size))
    return known, state, root


@pytest.mark.parametrize("fast", [True, False])
def test_pairs_of_the_redundant_model_are_halves_of_its_points(
    monkeypatch: pytest.MonkeyPatch, fast: bool
) -> None:
    known, state, root = _problem()
    monkeypatch.setattr(compiled, "available", lambda: fast)
    model = redundant_model.redundant_model(known, 1.0, 0.01)
    assert model.paired is not None
    columns = np.ascontiguousarray(np.swapaxes(root, -2, -1))
    size, scale, core = len(root[0]), 3.0, redundant_model.CORE
    errors = scale * np.concatenate([np.zeros((3, 1, size)), columns, -columns], axis=1)
    points = state[:, None] + errors

    def halves(values: Array) -> tuple[Array, Array, Array]:
        at, up, down = values[:, :1], values[:, 1 : size + 1], values[:, size + 1 :]
        return at[:, 0], 0.5 * (up - down) / scale, (0.5 * (up + down) - at) / scale

    wanted = halves(model.measurement(points, 0))
    for found, half in zip(model.paired.show(state, columns, scale), wanted):
        np.testing.assert_allclose(found, half, rtol=0, atol=1e-12 * np.abs(wanted[0]).max())
    at, odd, even = halves(model.process(points, 0))
    loose = model.paired.move(state, columns, scale)
    for found, half in (
        *((state, at), (loose[:, :core], odd[:, :core]), (columns[:, core:], odd[:, core:])),
        *((loose[:, core:], even[:, :core]), (np.zeros_like(even[:, core:]), even[:, core:])),
    ):
        np.testing.assert_allclose(found, half, rtol=0, atol=1e-12 * np.abs(at).max())


@pytest.mark.parametrize("loops", [True, False])
@pytest.mark.parametrize("noise", [0.0, 1e-8])
def test_the_filter_by_a_root_is_the_filter_by_sigma_points(
    monkeypatch: pytest.MonkeyPatch, noise: float, loops: bool
) -> None:
    """Some is not observed, one run has no start, and one is lost on the way."""
    monkeypatch.setattr(compiled, "available", lambda: loops)
    known, truth, root = _problem()
    size = len(root[0])
    variance = noise * np.arange(size)
    model = redundant_model.redundant_model(known, 1.0, 0.01, variance)
    draws = np.random.default_rng(5)
    truth, root = truth[[0, 1, 2, 1, 2]], 0.2 * root[[0, 1, 2, 1, 2]]
    state, measured = truth + (root @ draws.normal(size=(5, size, 1)))[..., 0], []
    for k in range(8):
        truth = truth if k == 0 else model.process(truth[:, None], k)[:, 0]
        measured.append(model.measurement(truth, k))
    y = np.stack(measured, axis=1) + draws.normal(size=(5, 8, 9)) * [*8 * [1.0], 0.01]
    y[draws.random(y.shape) < 0.2] = np.nan
    y[0, 3], state[3, 0], y[4, 5, 2] = np.nan, np.nan, np.inf
    given = state, root @ np.swapaxes(root, -2, -1), y, UnscentedParameters(1.0, 0.0, 0.0), [2]
    slow, fast = unscented(model._replace(paired=None), *given), unscented(model, *given)
    assert list(fast.status) == list(slow.status)
    assert np.isnan(fast.sigma[4, 5]).all() and np.isfinite(fast.sigma[4, 4]).all()
    sound = [0, 1, 2]
    error = np.abs(fast.state - slow.state)[sound] / slow.sigma[sound]
    assert error.max() < 1e-9
    np.testing.assert_allclose(fast.sigma[sound], slow.sigma[sound], rtol=1e-9)
    np.testing.assert_allclose(fast.nis[sound], slow.nis[sound], rtol=1e-9)
    spread = np.einsum("rki,rkj->rkij", *2 * [slow.sigma[sound][:, slow.kept]])
    assert (np.abs(fast.covariance - slow.covariance)[sound] / spread).max() < 1e-9
    assert (fast.nis_dof == slow.nis_dof).all()
