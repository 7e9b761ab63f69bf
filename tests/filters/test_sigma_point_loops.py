"""Compiled sigma points against the numpy code, whose oracles are in test_unscented_*."""

import numpy as np
import pytest

from debrisest import compiled
from debrisest.dynamics.integrators import rk4_step
from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.filters.model import Model
from debrisest.problems.tumbling import attitude

pytest.importorskip("numba")


@pytest.mark.parametrize("redraw", [True, False])
@pytest.mark.parametrize("spread", [(1.0, 2.0, 0.0), (0.5, 0.0, 1.0)])
def test_the_filter_is_the_same_with_loops(
    monkeypatch: pytest.MonkeyPatch, redraw: bool, spread: tuple[float, float, float]
) -> None:
    draws, n, m = np.random.default_rng(3), 6, 4
    mix, seen, root = (draws.normal(size=(k, n)) / n for k in (n, m, n))
    correlated = draws.normal(size=(m, m))
    model = Model(
        process=lambda x, _: np.sin(x @ mix.T),
        measurement=lambda x, _: np.exp(x @ seen.T),
        process_noise=1e-3 * np.eye(n),
        measurement_noise=0.01 * np.eye(m) + 1e-3 * correlated @ correlated.T,
        error_names=tuple("abcdef"),
    )
    covariance = np.tile(root @ root.T + 1e-3 * np.eye(n), (7, 1, 1))
    y = np.exp(0.1 * draws.normal(size=(7, 6, m)))
    y[draws.random(y.shape) < 0.2] = np.nan
    y[2, 3] = np.nan
    given = model, draws.normal(size=(7, n)), covariance, y, UnscentedParameters(*spread)
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        found.append(unscented(*given, keep=range(6), redraw=redraw))
    for name in ("state", "sigma", "covariance", "nis"):
        loops, plain = (getattr(each, name) for each in found)
        np.testing.assert_allclose(loops, plain, rtol=1e-12, atol=1e-12 * np.abs(plain).max())


@pytest.mark.parametrize("step", [0.01, 1.0, -1.0])
def test_sigma_points_of_a_tumbling_body_move_the_same(
    monkeypatch: pytest.MonkeyPatch, step: float
) -> None:
    """Slow and fast ones, more than fit into one vector, and moments near zero."""
    draws = np.random.default_rng(9)
    state = draws.normal(size=(5, 9, 14))
    state[..., attitude.RATE] *= draws.choice([0.01, 0.3, 2.0], size=(5, 9, 1))
    state[0, :3, attitude.MOMENTS] *= 1e-3
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        found.append(attitude.process(state, step, rk4_step))
    np.testing.assert_allclose(*found, rtol=1e-11, atol=1e-12 * np.abs(found[1]).max())
