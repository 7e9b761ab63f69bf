"""Jacobi's elliptic functions, accurate up to the modulus 1.

`scipy.special.ellipj` takes the parameter ``m = k^2``, which near 1 has lost the digits that
matter, and beyond ``1 - 1e-10`` it is wrong for arguments longer than a quarter period. Here the
complement ``1 - m`` is given, which a body that tumbles near its separatrix has in full.
"""

from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array


def quarter_period(complement: Array) -> Array:
    """Complete integral ``K`` for the complementary parameter ``1 - m``."""
    return np.asarray(scipy.special.ellipkm1(complement))


class Modulus(NamedTuple):
    """What all arguments share, arrays of one shape."""

    quarter: Array
    """Quarter period."""
    landen: list[tuple[Array, Array]]
    """Moduli ``k1`` of the successive transformations, with ``1 - k1``."""


def modulus_of(complement: Array) -> Modulus:
    """Return what functions of all arguments need of the complementary parameter ``1 - m``."""
    return Modulus(quarter_period(complement), _landen_moduli(complement))


def elliptic(argument: Array, complement: Array | Modulus) -> tuple[Array, Array, Array]:
    """``sn, cn, dn`` of real arguments, for ``0 < 1 - m <= 1``.

    Descending Landen transformations (DLMF 22.7(i)) down to the circular functions. ``1 - k1 sn^2``
    is written as ``(1 - k1) + k1 cn^2``, so that small values of ``cn`` and ``dn`` keep all digits.
    """
    modulus = complement if isinstance(complement, Modulus) else modulus_of(complement)
    angle = argument / (4.0 * modulus.quarter)
    angle -= np.round(angle)
    angle *= 2.0 * np.pi
    sn, cn = np.sin(angle), np.cos(angle)
    dn = np.ones_like(angle)
    for k1, rest in reversed(modulus.landen):
        divisor = k1 * sn
        divisor *= sn
        divisor += 1.0
        sn *= 1.0 + k1
        sn /= divisor
        next_dn = k1 * cn
        next_dn *= cn
        next_dn += rest
        next_dn /= divisor
        cn *= dn
        cn /= divisor
        dn = next_dn
    return sn, cn, dn


def _landen_moduli(complement: Array) -> list[tuple[Array, Array]]:
    """Moduli ``k1`` of the successive transformations, with ``1 - k1``, until they vanish.

    Each has as many as it would have alone; transformations with ``k1 = 0`` change no bit.
    """
    moduli: list[tuple[Array, Array]] = []
    k_prime, going = np.sqrt(complement), np.ones_like(complement, dtype=np.bool_)
    while not moduli or np.any(going):
        modulus, rest = (1.0 - k_prime) / (1.0 + k_prime), 2.0 * k_prime / (1.0 + k_prime)
        moduli.append((np.where(going, modulus, 0.0), np.where(going, rest, 1.0)))
        k_prime, going = 2.0 * np.sqrt(k_prime) / (1.0 + k_prime), going & (modulus > 1e-9)
    return moduli
