"""Inertia as five log-ratios: the matrix exponential, its inverse and its derivative."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from debrisest.dynamics import log_inertia

FIVE = st.lists(st.floats(-1.0, 1.0), min_size=5, max_size=5).map(np.array)


@given(FIVE)
def test_it_is_the_exponential_of_a_traceless_matrix(s: np.ndarray) -> None:
    tensor = log_inertia.inertia(s)
    matrix = np.tensordot(s, log_inertia.BASIS, 1)
    assert np.trace(matrix) == pytest.approx(0.0, abs=1e-15)
    np.testing.assert_allclose(tensor, expm(matrix), atol=1e-12)
    assert np.linalg.det(tensor) == pytest.approx(1.0, abs=1e-10)


@given(FIVE, st.floats(0.01, 1e4))
def test_the_scale_is_lost_and_nothing_else(s: np.ndarray, scale: float) -> None:
    found = log_inertia.log_ratios(scale * log_inertia.inertia(s))
    np.testing.assert_allclose(found, s, atol=1e-10)


def test_the_length_does_not_depend_on_the_axes() -> None:
    rng = np.random.default_rng(0)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    tensor = np.diag([135.4, 208.3, 260.4])
    lengths = [np.linalg.norm(log_inertia.log_ratios(t)) for t in (tensor, turn @ tensor @ turn.T)]
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-12)


@pytest.mark.parametrize("scale", [1.0, 1e-3, 0.0])
def test_derivative_also_where_moments_are_equal(scale: float) -> None:
    s = scale * np.random.default_rng(1).normal(size=(4, 5))
    tensor, inverse, derivative = log_inertia.with_derivative(s)
    np.testing.assert_allclose(tensor, log_inertia.inertia(s), atol=1e-13)
    np.testing.assert_allclose(inverse @ tensor, np.broadcast_to(np.eye(3), (4, 3, 3)), atol=1e-12)
    for k, step in enumerate(1e-5 * np.eye(5)):
        change = log_inertia.inertia(s + step) - log_inertia.inertia(s - step)
        np.testing.assert_allclose(derivative[:, k], change / 2e-5, atol=1e-8)
