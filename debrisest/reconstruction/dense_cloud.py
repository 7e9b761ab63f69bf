"""Points with outward normals from depth images, averaged over the images."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.depth import Depth, DepthView
from debrisest.vision.libraries import vision_library

_SMOOTHED_PX = 2.0
_STEP_PX = 4
"""To the neighbours from which a normal is taken."""
_EVERY_PX = 2
_JUMP = 0.01
"""Relative difference of the depth from the smoothed one at which it ends."""
_LEAST_COSINE = 0.35
"""Of the normal to the line of sight."""
_LEAST_POINTS = 3
_AGREED = 0.7
"""Length of the mean of unit normals below which they do not agree."""


class OrientedCloud(NamedTuple):
    """Points of a surface."""

    points: Array
    """(point, 3), m."""
    normals: Array
    """Outward unit vectors (point, 3)."""


def dense_cloud(views: Sequence[DepthView], cell: float) -> OrientedCloud:
    """Return one point for each cell, m, and side of the surface that at least three pixels show.

    Points on different sides of a thin panel are averaged apart.
    """
    found = [_points(each) for each in views]
    points = np.concatenate([points for points, _ in found])
    normals = np.concatenate([normals for _, normals in found])
    axis = np.abs(normals).argmax(axis=1)
    side = np.take_along_axis(normals, axis[:, None], axis=1) > 0
    place = np.floor(points / cell).astype(np.int64)
    key = np.concatenate([place, axis[:, None], side], axis=1)
    _, group, counts = np.unique(key, axis=0, return_inverse=True, return_counts=True)
    group = group.reshape(-1)
    mean_point, mean_normal = (
        np.stack([np.bincount(group, column) for column in each.T], axis=1) / counts[:, None]
        for each in (points, normals)
    )
    length = np.linalg.norm(mean_normal, axis=1)
    kept = (counts >= _LEAST_POINTS) & (length > _AGREED)
    if kept.sum() < 100:
        raise ValueError("too little depth is found: the body has too little texture or light")
    return OrientedCloud(mean_point[kept], mean_normal[kept] / length[kept, None])


def _points(found: DepthView) -> tuple[Array, Array]:
    """Return points (point, 3) and unit normals of a depth image in the axes of the structure."""
    view, depth = found
    smooth = _smoothed(depth)
    v, u = np.indices(depth.shape)
    focal, centre = view.matrix[0, 0], view.matrix[:2, 2]
    rays = np.stack([(u - centre[0]) / focal, (v - centre[1]) / focal, np.ones_like(u)], axis=-1)
    space = rays * smooth[..., None]
    along_u, along_v = (np.full_like(space, np.nan) for _ in range(2))
    n = _STEP_PX
    along_u[:, n:-n] = space[:, 2 * n :] - space[:, : -2 * n]
    along_v[n:-n] = space[2 * n :] - space[: -2 * n]
    normals = np.cross(along_v, along_u)[::_EVERY_PX, ::_EVERY_PX].reshape(-1, 3)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-30)
    space = space[::_EVERY_PX, ::_EVERY_PX].reshape(-1, 3)
    cosine = -(normals * space).sum(-1) / np.linalg.norm(space, axis=-1)
    good = cosine > _LEAST_COSINE
    return (space[good] - view.translation) @ view.rotation, normals[good] @ view.rotation


def _smoothed(depth: Depth) -> Array:
    """Return the depth, its inverse smoothed, NaN where it jumps."""
    cv2: Any = vision_library("cv2")
    known = np.isfinite(depth)
    inverse = np.where(known, 1.0 / np.where(known, depth, 1.0), 0.0).astype(np.float32)
    inverse = cv2.medianBlur(inverse, 5)
    known &= inverse > 0.0
    weight = cv2.GaussianBlur(known.astype(np.float32), (0, 0), _SMOOTHED_PX)
    smooth = cv2.GaussianBlur(np.where(known, inverse, np.float32(0)), (0, 0), _SMOOTHED_PX)
    smooth /= np.maximum(weight, 1e-3)
    known &= np.abs(smooth - inverse) < _JUMP * smooth
    return np.where(known, 1.0 / np.maximum(smooth, 1e-9), np.nan)
