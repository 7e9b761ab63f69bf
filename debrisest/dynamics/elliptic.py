"""Jacobi's elliptic functions, accurate up to the modulus 1.

`scipy.special.ellipj` takes the parameter ``m = k^2``, which near 1 has lost the digits that
matter, and beyond ``1 - 1e-10`` it is wrong for arguments longer than a quarter period. Here the
complement ``1 - m`` is given, which a body that tumbles near its separatrix has in full.
"""

import numpy as np
from scipy.special import ellipkm1

from debrisest.arrays import Array


def quarter_period(complement: Array) -> Array:
    """Complete integral ``K`` for the complementary parameter ``1 - m``."""
    return np.asarray(ellipkm1(complement))


def elliptic(argument: Array, complement: Array) -> tuple[Array, Array, Array]:
    """``sn, cn, dn`` of real arguments, for ``0 < 1 - m <= 1``.

    Amplitude by the descending arithmetic-geometric mean (DLMF 22.20(ii)), its arc sine written as
    an arc tangent, which stays accurate at ``m = 1``.
    """
    period = 4.0 * quarter_period(complement)
    argument = argument - period * np.round(argument / period)
    amplitude = _amplitude(argument, complement)
    sn, cn = np.sin(amplitude), np.cos(amplitude)
    return sn, cn, np.sqrt(cn * cn + complement * sn * sn)


def _amplitude(argument: Array, complement: Array) -> Array:
    means = _mean_sequence(complement)
    phase = np.ldexp(means[-1][0] * argument, len(means) - 1)
    for mean, geometric, difference in means[:0:-1]:
        sine, cosine = np.sin(phase), np.cos(phase)
        adjacent = np.sqrt((mean * cosine) ** 2 + (geometric * sine) ** 2)
        phase = 0.5 * (phase + np.arctan2(difference * sine, adjacent))
    return phase


def _mean_sequence(complement: Array) -> list[tuple[Array, Array, Array]]:
    """``(a, b, c)`` of the arithmetic-geometric mean of 1 and ``k'``, until ``c`` vanishes."""
    sequence = [(np.ones_like(complement), np.sqrt(complement), np.sqrt(1.0 - complement))]
    while np.any(sequence[-1][2] > 1e-9 * sequence[-1][0]):
        a, b, _ = sequence[-1]
        sequence.append((0.5 * (a + b), np.sqrt(a * b), 0.5 * (a - b)))
    return sequence
