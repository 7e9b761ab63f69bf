"""The rotation of an estimated shape that fits the true one best, about the centre of mass.

The body axes of an unknown target are defined by the first image and measured by no other one, so
that a filter may turn them, with everything that is told in them, and notice nothing. Errors after
this rotation are free of that choice of axes (gauge).
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.rotation import nearest_rotation

_FLAT = 1e-12
"""Ratio of singular values below which points are in line."""


def best_rotation(estimated: Array, true: Array) -> Array:
    """Proper rotation ``Q (..., 3, 3)`` with the least ``sum |Q estimated - true|^2``.

    Points are ``(..., feature, 3)`` from the centre of mass, which is not moved; a point that is
    NaN on either side does not count. NaN where all that count are in line with the centre.
    """
    known = np.isfinite(estimated + true).all(-1, keepdims=True)
    left = np.where(known, true, 0.0)
    right = np.where(known, estimated, 0.0)
    rotation, scale = nearest_rotation(np.swapaxes(left, -1, -2) @ right)
    definite = scale[..., 1] > _FLAT * scale[..., 0]
    return np.where(definite[..., None, None], rotation, np.nan)


def rms_distance(estimated: Array, true: Array) -> Array:
    """Root mean square ``(...)``, m, over the points ``(..., feature, 3)`` that are known."""
    square = ((estimated - true) ** 2).sum(-1)
    known = np.isfinite(square)
    count = known.sum(-1)
    total = np.where(known, square, 0.0).sum(-1)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sqrt(total / np.where(count > 0, count, np.nan)))


def shape_error(estimated: Array, true: Array) -> Array:
    """Relative error ``(...)`` of inertia tensors ``(..., 3, 3)``, each divided by its trace."""
    scaled = estimated / np.trace(estimated, axis1=-2, axis2=-1)[..., None, None]
    reference = true / np.trace(true, axis1=-2, axis2=-1)[..., None, None]
    size = np.linalg.norm(reference, axis=(-2, -1))
    return np.asarray(np.linalg.norm(scaled - reference, axis=(-2, -1)) / size)
