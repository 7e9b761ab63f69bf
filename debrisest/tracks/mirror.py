"""Points that match others as a mirror image only."""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.tracks.types import Tracks

_MIRRORED = 100.0  # ratio of squared residuals of the best rotation and the best reflection


def reflections(tracks: Tracks) -> list[str]:
    """Neighbouring epochs that match by a mirror image only."""
    assert tracks.points is not None
    mirrored = is_mirrored(tracks.points[:-1], tracks.points[1:])
    found = np.flatnonzero(mirrored)
    if not found.size:
        return []
    lines = tracks.lines[found[0]], tracks.lines[found[0] + 1]
    said = f"{found.size} neighbouring epochs match as mirror images only, first lines"
    hint = "is an axis' sign changed, or are two columns swapped, in a part of the file?"
    return [f"{tracks.source}: {said} {lines[0]} and {lines[1]}; {hint}"]


def is_mirrored(first: Array, second: Array) -> Array:
    """Whether points ``(..., feature, 3)`` match others far better by a reflection.

    From the singular values s of the correlation: the residual of the best orthogonal matrix is
    ``|a|^2 + |b|^2 - 2 sum s``, that of the best rotation larger by ``4 s_3`` if they differ. Flat
    bodies, ``s_3 = 0``, are their own mirror image.
    """
    seen = np.asarray(~np.isnan(first + second).any(-1, keepdims=True))
    count = np.asarray(seen.sum(-2, keepdims=True))
    a, b = (_centred(points, seen, count) for points in (first, second))
    left, scale, right = np.linalg.svd(np.swapaxes(a, -1, -2) @ b)
    improper = np.linalg.det(left) * np.linalg.det(right) < 0
    total = np.sum(a * a, axis=(-2, -1)) + np.sum(b * b, axis=(-2, -1))
    residual = np.maximum(total - 2 * scale.sum(-1), 1e-14 * total)
    solid = (count[..., 0, 0] >= 4) & (scale[..., 2] > 1e-3 * scale[..., 0])
    return np.asarray(improper & solid & (4 * scale[..., 2] > _MIRRORED * residual))


def _centred(points: Array, seen: BoolArray, count: IntArray) -> Array:
    mean = np.sum(points, axis=-2, keepdims=True, where=seen) / np.maximum(count, 1)
    return np.where(seen, points - mean, 0.0)
