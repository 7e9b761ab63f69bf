"""The fast transforms against the dictionary written out as a matrix."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.recovery.fourier import (
    analyse,
    dictionary_length,
    l1_norm,
    soft_threshold,
    synthesise,
)

sizes = st.tuples(st.integers(1, 20), st.integers(0, 25)).map(lambda s: (s[0], s[0] + s[1]))
seeds = st.integers(0, 2**32 - 1)


def dictionary(samples, length):
    """Phi of Eq. 14, samples x atoms."""
    return np.exp(2j * np.pi * np.outer(np.arange(samples), np.arange(length)) / length)


def full_spectrum(half, length):
    """The Hermitian spectrum (length) of which `half` is the first half."""
    return np.array(
        [half[u] if u <= length // 2 else np.conj(half[length - u]) for u in range(length)]
    )


def half_spectrum(rng, length):
    """Coefficients of a real signal."""
    return np.fft.rfft(rng.standard_normal(length))


@given(sizes)
def test_zero_padded_dictionary_is_a_tight_frame(size):
    samples, length = size
    phi = dictionary(samples, length)
    np.testing.assert_allclose(phi @ phi.conj().T, length * np.eye(samples), atol=1e-9)
    unit = np.eye(samples)
    np.testing.assert_allclose(
        synthesise(analyse(unit, length), length, samples), length * unit, atol=1e-10
    )


@given(sizes, seeds)
def test_transforms_are_the_matrix_and_its_adjoint(size, seed):
    samples, length = size
    rng = np.random.default_rng(seed)
    phi = dictionary(samples, length)
    half = half_spectrum(rng, length)
    signal = rng.standard_normal(samples)
    np.testing.assert_allclose(
        synthesise(half, length, samples), phi @ full_spectrum(half, length), atol=1e-9
    )
    np.testing.assert_allclose(
        analyse(signal, length), (phi.conj().T @ signal)[: length // 2 + 1], atol=1e-9
    )


@given(sizes, seeds)
def test_l1_norm_counts_the_full_spectrum(size, seed):
    length = size[1]
    half = half_spectrum(np.random.default_rng(seed), length)
    np.testing.assert_allclose(l1_norm(half, length), np.abs(full_spectrum(half, length)).sum())


def test_coherence_needs_the_conjugate_that_eq_15_lacks():
    phi = dictionary(30, 30)
    off_diagonal = ~np.eye(30, dtype=bool)
    assert np.abs(phi.conj().T @ phi)[off_diagonal].max() < 1e-12 * 30**2
    assert np.abs(phi.T @ phi)[off_diagonal].max() == pytest.approx(30)


@given(seeds, st.floats(1e-3, 3.0))
def test_soft_threshold_minimises_modulus_plus_squared_distance(seed, threshold):
    rng = np.random.default_rng(seed)
    z = rng.standard_normal(40) + 1j * rng.standard_normal(40)
    result = soft_threshold(z, threshold)

    def cost(x):
        return threshold * np.abs(x) + 0.5 * np.abs(x - z) ** 2

    for size in (1e-4, 1e-2, 1.0):
        other = result + size * (rng.standard_normal(40) + 1j * rng.standard_normal(40))
        assert (cost(result) <= cost(other)).all()
    assert (result[np.abs(z) <= threshold] == 0).all()


def test_soft_threshold_of_zero_is_zero():
    z = np.array([0.0, 3.0 + 4.0j])
    np.testing.assert_allclose(soft_threshold(z, 1.0), [0.0, 2.4 + 3.2j])


@given(st.integers(1, 5000), st.floats(1.0, 4.0))
def test_length_is_exact_for_ratio_one_and_else_at_least_the_ratio(samples, ratio):
    assert dictionary_length(samples, 1) == samples
    length = dictionary_length(samples, ratio)
    assert samples * ratio <= length <= 1.3 * samples * ratio + 8


def test_ratio_below_one_is_refused():
    with pytest.raises(ValueError, match="at least 1"):
        dictionary_length(10, 0.9)
