"""Quantiles of the compiled loops against numpy's."""

import numpy as np
import pytest

from debrisest.compiled import available


@pytest.mark.skipif(not available(), reason="numba is not installed")
@pytest.mark.parametrize("count", [1, 2, 3, 10, 101])
@pytest.mark.parametrize("share", [0.0, 0.5, 0.8, 1.0])
def test_quantiles_are_those_of_numpy(count: int, share: float) -> None:
    """Also of values of which many are the same."""
    from debrisest.order_loops import quantile

    draws = np.random.default_rng(count)
    for values in (draws.normal(size=count), np.round(draws.normal(size=count)), np.ones(count)):
        expected = np.quantile(values, share)
        np.testing.assert_allclose(quantile(values.copy(), share), expected, rtol=1e-13, atol=1e-13)
