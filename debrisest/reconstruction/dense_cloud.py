"""Points with outward normals from depth images, averaged over the images."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.depth import DepthView
from debrisest.reconstruction.normals import facing_surface

_EVERY_PX = 2
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
    space, normals, cosine = (
        each[::_EVERY_PX, ::_EVERY_PX].reshape(-1, *each.shape[2:])
        for each in facing_surface(found)
    )
    good = cosine > _LEAST_COSINE
    return found.view.from_camera(space[good]), normals[good]
