"""Elliptic functions: scipy away from the modulus 1, special values and limits near it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import ellipj, ellipk

from debrisest.dynamics.elliptic import elliptic, quarter_period

COMPLEMENTS = [1.0, 0.9, 0.3, 1e-2, 1e-5, 1e-10, 1e-30, 1e-100, 1e-290]


@given(st.floats(-400.0, 400.0), st.floats(0.0, 0.999))
def test_matches_scipy_away_from_modulus_one(argument, parameter) -> None:
    ours = elliptic(np.array(argument), np.array(1.0 - parameter))
    theirs = ellipj(argument, 1.0 - (1.0 - parameter))[:3]
    np.testing.assert_allclose(ours, theirs, atol=2e-10 / (1.0 - parameter) ** 0.5 * 1e-2)
    assert quarter_period(np.array(1.0 - parameter)) == pytest.approx(ellipk(parameter), rel=1e-12)


@pytest.mark.parametrize("complement", COMPLEMENTS)
def test_values_at_fractions_of_the_quarter_period(complement) -> None:
    """DLMF 22.5; the values at K/2 are functions of ``k'`` alone."""
    k1 = np.sqrt(complement)
    quarter = quarter_period(np.array(complement))
    half = [1 / np.sqrt(1 + k1), np.sqrt(k1 / (1 + k1)), np.sqrt(k1)]
    for shift, signs in ((0.0, (1, 1, 1)), (4.0, (1, 1, 1)), (-2.0, (-1, -1, 1))):
        values = elliptic(np.array((shift + 0.5) * quarter), np.array(complement))
        np.testing.assert_allclose(values, np.array(signs) * half, rtol=1e-12, atol=0)
    at_quarter = elliptic(np.array(quarter), np.array(complement))
    np.testing.assert_allclose(at_quarter, [1.0, 0.0, k1], rtol=1e-10, atol=1e-15)


@given(st.floats(-30.0, 30.0))
def test_hyperbolic_limit(argument) -> None:
    values = elliptic(np.array(argument), np.array(1e-200))
    expected = [np.tanh(argument), 1 / np.cosh(argument), 1 / np.cosh(argument)]
    np.testing.assert_allclose(values, expected, rtol=1e-10, atol=1e-15)


@given(st.floats(-1e4, 1e4), st.sampled_from(COMPLEMENTS))
def test_identities(argument, complement) -> None:
    sn, cn, dn = elliptic(np.array(argument), np.array(complement))
    assert sn**2 + cn**2 == pytest.approx(1.0, abs=2e-13)
    assert dn**2 + (1.0 - complement) * sn**2 == pytest.approx(1.0, abs=2e-13)
    assert dn > 0.0
