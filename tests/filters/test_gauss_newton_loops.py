"""A compiled Gauss-Newton step against the numpy code, whose oracles are in test_extended_*."""

import numpy as np
import pytest

from debrisest import compiled
from debrisest.filters.kalman.extended import extended
from debrisest.filters.model import Model

pytest.importorskip("numba")

N, M = 7, 5
DRAWS = np.random.default_rng(8)
MIX, SEEN = DRAWS.normal(size=(N, N)) / N, DRAWS.normal(size=(M, N))


def _model(noise: float) -> Model:
    return Model(
        process=lambda x, _: np.sin(x @ MIX.T),
        measurement=lambda x, _: np.exp(0.3 * (x @ SEEN.T)),
        process_noise=1e-3 * np.diag(np.arange(N)),
        measurement_noise=np.diag(np.geomspace(noise, 1.0, M)),
        error_names=tuple("abcdefg"),
    )


@pytest.mark.parametrize("iterations", [1, 4])
@pytest.mark.parametrize("noise", [1e-6, 0.1])
def test_the_filter_is_the_same_with_loops(
    monkeypatch: pytest.MonkeyPatch, iterations: int, noise: float
) -> None:
    """Precise or not, some not observed, and one component known exactly."""
    model, runs = _model(noise), 6
    root = 0.3 * DRAWS.normal(size=(N, N))
    root[3] = 0.0
    covariance = np.tile(root @ root.T, (runs, 1, 1))
    state = DRAWS.normal(size=(runs, N)) @ root.T
    y = np.exp(0.1 * DRAWS.normal(size=(runs, 5, M)))
    y[DRAWS.random(y.shape) < 0.2] = np.nan
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        found.append(extended(model, state, covariance, y, iterations=iterations, keep=range(5)))
    loops, plain = found
    scale = np.maximum(plain.sigma, 1e-3)
    assert (np.abs(loops.state - plain.state) / scale).max() < 1e-9
    assert (np.abs(loops.sigma - plain.sigma) / scale).max() < 1e-9
    both = scale[..., :, None] * scale[..., None, :]
    assert (np.abs(loops.covariance - plain.covariance) / both).max() < 1e-9
    np.testing.assert_allclose(loops.nis, plain.nis, rtol=1e-9)
    for name in ("updates", "repairs"):
        np.testing.assert_array_equal(loops.counts[name], plain.counts[name])


def test_noises_that_are_not_independent_are_left_to_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    model = _model(0.1)
    model = model._replace(measurement_noise=model.measurement_noise + 0.02)
    state, y = np.zeros((2, N)), np.ones((2, 3, M))
    found = []
    for fast in (True, False):
        monkeypatch.setattr(compiled, "available", lambda fast=fast: fast)
        found.append(extended(model, state, np.tile(np.eye(N), (2, 1, 1)), y))
    np.testing.assert_array_equal(found[0].state, found[1].state)
