"""A triangular root of a covariance, with and without loops, against the covariance itself."""

import numpy as np
import pytest

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.filters.kalman.root import correct, fold


@pytest.fixture(params=[True, False], autouse=True)
def loops(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.param:
        pytest.importorskip("numba")
    monkeypatch.setattr(compiled, "available", lambda: request.param)


def _columns(draws: np.random.Generator, runs: int, n: int) -> Array:
    root = np.tril(0.3 * draws.normal(size=(runs, n, n))) + np.eye(n)
    return np.ascontiguousarray(np.swapaxes(root, -2, -1))


def _squares(columns: Array) -> Array:
    return np.asarray(np.swapaxes(columns, -2, -1) @ columns)


@pytest.mark.parametrize("own", [0, 7, 20])
@pytest.mark.parametrize("count", [20, 33])
def test_folded_columns_have_the_squares_of_all(own: int, count: int) -> None:
    draws = np.random.default_rng(own)
    columns, loose = _columns(draws, 3, 20), draws.normal(size=(3, count, 20))
    loose[1, own:] = 0.0
    wanted = _squares(columns[:, own:]) + _squares(loose)
    assert not fold(columns, loose, own).any()
    np.testing.assert_allclose(_squares(columns), wanted, atol=1e-12 * wanted.max())
    assert not np.tril(columns, -1).any()


@pytest.mark.parametrize("n", [1, 16, 37])
@pytest.mark.parametrize("m", [1, 6])
def test_a_corrected_root_is_that_of_the_kalman_filter(n: int, m: int) -> None:
    """Whatever is precise, and whatever is not observed."""
    draws = np.random.default_rng(10 * n + m)
    columns, response = _columns(draws, 3, n), draws.normal(size=(3, m, n))
    response[1] *= 1e3
    root = 0.1 * draws.normal(size=(3, m, m)) + np.eye(m)
    noise = root @ np.swapaxes(root, -2, -1)
    innovation = draws.normal(size=(3, m))
    innovation[2, 0] = np.nan
    covariance = _squares(columns)
    odd = np.ascontiguousarray(columns @ np.swapaxes(response, -2, -1))
    correction, variance, nis, repairs = correct(columns, odd, noise.copy(), innovation.copy())
    assert not repairs.any()
    assert not np.tril(columns, -1).any()
    for run in range(3):
        seen = ~np.isnan(innovation[run])
        h, nu = response[run][seen], innovation[run][seen]
        total = h @ covariance[run] @ h.T + noise[run][np.ix_(seen, seen)]
        gain = np.linalg.solve(total, h @ covariance[run]).T
        kept = np.eye(n) - gain @ h
        wanted = kept @ covariance[run] @ kept.T + gain @ noise[run][np.ix_(seen, seen)] @ gain.T
        scale = 1e-10 * np.abs(covariance[run]).max()
        np.testing.assert_allclose(_squares(columns)[run], wanted, atol=scale)
        np.testing.assert_allclose(variance[run], np.diag(wanted), atol=scale)
        np.testing.assert_allclose(correction[run], gain @ nu, atol=1e-10)
        np.testing.assert_allclose(nis[run], nu @ np.linalg.solve(total, nu), rtol=1e-9)
