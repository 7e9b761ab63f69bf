"""Tropp's exact recovery coefficient of the lines that were found (Biondi et al. 2017, Sec. 3).

    ERC = 1 - max_{k not in L} | (Phi_L* Phi_L)^-1 Phi_L* phi_k |_1

of the atoms L that are used, at the observed epochs. Where it is positive, most solvers find a
signal of these atoms exactly; where it is not, the theory promises nothing.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, ComplexArray


def exact_recovery_coefficient(
    coefficients: ComplexArray, observed: BoolArray, length: int
) -> Array:
    """ERC (...) of half spectra (..., length // 2 + 1) and `observed` epochs (..., time).

    NaN where nothing is observed or no line is used, minus infinity where the lines that are used
    cannot be told apart at these epochs.
    """
    batch = coefficients.shape[:-1]
    spectra = coefficients.reshape(-1, coefficients.shape[-1])
    masks = np.broadcast_to(observed, (*batch, observed.shape[-1])).reshape(len(spectra), -1)
    each = [_coefficient(v, mask, length) for v, mask in zip(spectra, masks)]
    return np.array(each).reshape(batch)


def _coefficient(half: ComplexArray, observed: BoolArray, length: int) -> float:
    lines = np.flatnonzero(half)
    used = np.unique(np.concatenate([lines, -lines % length]))
    others = np.setdiff1d(np.arange(length), used)
    if not (used.size and others.size and observed.any()):
        return np.nan
    products = np.conj(np.fft.fft(observed.astype(np.float64), length))
    gram = products[(used[None, :] - used[:, None]) % length]
    with_others = products[(others[None, :] - used[:, None]) % length]
    try:
        explained = np.linalg.solve(gram, with_others)
    except np.linalg.LinAlgError:
        return -np.inf
    return float(1.0 - np.abs(explained).sum(axis=0).max())
