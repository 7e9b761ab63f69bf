"""Unlabelled points of a camera: what belongs to the target, and clutter, in random order."""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray


def around(pixel: Array, unit: Array, half_width: float) -> Array:
    """Clutter ``(..., count, 2)`` spread evenly over a square about a pixel ``(..., 2)``.

    ``unit (..., count, 2)`` are draws from [0, 1). NaN where the pixel is.
    """
    return np.asarray(pixel[..., None, :] + half_width * (2.0 * unit - 1.0))


def in_image(pixel: Array, half_size: Array) -> BoolArray:
    """Return which pixels ``(..., 2)`` an image of ``half_size (..., 2)`` can hold."""
    return np.asarray(np.all(np.abs(pixel) <= half_size, axis=-1))


def unlabelled(point: Array, rank: Array) -> tuple[Array, IntArray]:
    """Return points ``(..., count, 2)`` in the order of ``rank (..., count)``, NaN last.

    Beside them, the place ``(...,)`` to which the first point, the target's own, has come: -1 if
    it is NaN.
    """
    seen: BoolArray = np.asarray(np.isfinite(point).all(axis=-1))
    order = np.argsort(np.where(seen, rank, np.inf), axis=-1, kind="stable")
    place = np.argmin(order, axis=-1)
    shuffled = np.take_along_axis(point, order[..., None], axis=-2)
    return shuffled, np.where(seen[..., 0], place, -1)
