"""Lens distortion on the plane at depth 1: radial and tangential, as OpenCV has them.

Source: Brown 1971, with the coefficients in OpenCV's order, ``k1, k2, p1, p2, k3``.
"""

from collections.abc import Sequence

import numpy as np

from debrisest.arrays import Array

COEFFICIENTS = 5
"""Coefficients of the model; fewer mean that the rest are zero."""
_ITERATIONS = 200
_PRECISION = 1e-12


def distorted(slope: Array, coefficients: Sequence[float]) -> Array:
    """Slopes ``(..., 2)``, x/z and y/z, as the lens shows them."""
    radial, tangential = _terms(slope, coefficients)
    return np.asarray(slope * radial + tangential)


def undistorted(shown: Array, coefficients: Sequence[float]) -> Array:
    """Slopes ``(..., 2)`` that the lens shows as ``shown``, by fixed-point iteration.

    NaN where there is none that the iteration finds: far outside of what was calibrated.
    """
    slope = shown
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for _ in range(_ITERATIONS):
            radial, tangential = _terms(slope, coefficients)
            before, slope = slope, (shown - tangential) / radial
            if not (np.abs(slope - before) > _PRECISION).any():
                break
        off = np.abs(distorted(slope, coefficients) - shown).max(axis=-1, keepdims=True)
    return np.asarray(np.where(off < 1e3 * _PRECISION, slope, np.nan))


def _terms(slope: Array, coefficients: Sequence[float]) -> tuple[Array, Array]:
    """Radial factor ``(..., 1)`` and tangential part ``(..., 2)``."""
    k1, k2, p1, p2, k3 = (*coefficients, *[0.0] * (COEFFICIENTS - len(coefficients)))
    x, y = slope[..., 0], slope[..., 1]
    square = x * x + y * y
    radial = 1.0 + square * (k1 + square * (k2 + square * k3))
    tangential = np.stack(
        [2 * p1 * x * y + p2 * (square + 2 * x * x), p1 * (square + 2 * y * y) + 2 * p2 * x * y],
        axis=-1,
    )
    return radial[..., None], tangential
