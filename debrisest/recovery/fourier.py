"""The Fourier dictionary, zero padded, on the half spectra of real signals.

Atoms exp(2 pi i u k / n), k = 0..m-1, u = 0..n-1, with n >= m (Biondi et al. 2017, Eqs. 13-14).
The paper has n = m. Any n >= m is a tight frame, Phi Phi* = n I_m (Eq. 25), and n > m also has
frequencies between the lines of the plain transform and needs no period of m. Coefficients of a
real signal have Hermitian symmetry: the first n // 2 + 1 (the half spectrum) say everything.
"""

from math import ceil

import numpy as np
import scipy

from debrisest.arrays import Array, ComplexArray


def dictionary_length(samples: int, ratio: float) -> int:
    """Number n of atoms for signals of `samples` epochs, at least `ratio` times as many.

    A ratio of 1 is the plain transform of the paper, n = m exactly; any other is rounded up to a
    length whose transform is fast.
    """
    if ratio < 1:
        raise ValueError(f"the ratio of atoms to samples must be at least 1, not {ratio}")
    return samples if ratio == 1 else scipy.fft.next_fast_len(ceil(ratio * samples), real=True)


def synthesise(coefficients: ComplexArray, length: int, samples: int) -> Array:
    """Signals Phi c (..., samples) of half spectra (..., length // 2 + 1) (Eq. 13)."""
    signal: Array = scipy.fft.irfft(coefficients, length, norm="forward")
    return signal[..., :samples]


def analyse(signal: Array, length: int) -> ComplexArray:
    """Half spectra Phi* x (..., length // 2 + 1) of signals (..., time), zero padded."""
    spectrum: ComplexArray = scipy.fft.rfft(signal, length)
    return spectrum


def multiplicity(length: int) -> Array:
    """How often each line of a half spectrum (length // 2 + 1) occurs in the full one: 1 or 2."""
    count = np.full(length // 2 + 1, 2.0)
    count[0] = 1.0
    if length % 2 == 0:
        count[-1] = 1.0
    return count


def l1_norm(coefficients: ComplexArray, length: int, *, joint: bool = False) -> Array:
    """Sum (...) of the moduli over the full spectrum of half spectra (..., length // 2 + 1).

    Jointly, a line's modulus is the 2-norm over the components (..., component, line).
    """
    total: Array = _moduli(coefficients, joint) @ multiplicity(length)
    return total[..., 0] if joint else total


def soft_threshold(
    coefficients: ComplexArray, threshold: float, *, joint: bool = False
) -> ComplexArray:
    """Coefficients with moduli reduced by `threshold` > 0, exactly zero where they are below.

    Jointly, a line's modulus is the 2-norm over the components (..., component, line).
    """
    return coefficients * (1.0 - share_taken(coefficients, threshold, joint=joint))


def share_taken(coefficients: ComplexArray, threshold: float, *, joint: bool = False) -> Array:
    """Share of each coefficient (..., line) that `soft_threshold` takes: 1 where it is below."""
    share = _moduli(coefficients, joint)
    np.maximum(share, threshold, out=share)
    return np.divide(threshold, share, out=share)


def _moduli(coefficients: ComplexArray, joint: bool) -> Array:
    """Moduli, jointly with an axis of length 1 in the place of the components."""
    moduli: Array = np.abs(coefficients)
    if joint and coefficients.shape[-2] > 1:
        moduli = np.sqrt(np.sum(moduli * moduli, axis=-2, keepdims=True))
    return moduli
