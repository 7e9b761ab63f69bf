"""Points without their translation: orthonormal contrasts of those that are seen.

A translation that is unknown at every epoch is removed exactly by differences of the points. Those
of Helmert, each point less the mean of the seen ones before it, scaled, are orthonormal: white
noise of the points stays white, with the same variance, and no other information is lost.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray


def contrasts(points: Array, seen: BoolArray) -> Array:
    """Return contrasts ``(..., feature - 1, 3)`` of ``points (..., feature, 3)``.

    The one of a feature compares it with those before it in the catalogue; it is zero where the
    feature is not ``seen (..., feature)`` or is the first one that is, see `compared`.
    """
    counted = np.where(seen[..., None], points, 0.0)
    before = np.cumsum(counted, axis=-2)[..., :-1, :]
    count = _seen_before(seen)[..., None]
    mean = before / np.maximum(count, 1)
    contrast = np.sqrt(count / (count + 1.0)) * (counted[..., 1:, :] - mean)
    return np.asarray(np.where(seen[..., 1:, None], contrast, 0.0))


def compared(seen: BoolArray) -> BoolArray:
    """Return which contrasts ``(..., feature - 1)`` there are: one less than points are seen."""
    return np.asarray(seen[..., 1:] & (_seen_before(seen) > 0))


def _seen_before(seen: BoolArray) -> Array:
    return np.cumsum(seen[..., :-1], axis=-1, dtype=np.float64)
