"""Normals of a cloud that has none."""

import numpy as np
import scipy

from debrisest.arrays import Array
from debrisest.reconstruction.dense_cloud import OrientedCloud

_NEIGHBOURS = 12


def oriented(points: Array) -> OrientedCloud:
    """Return points (point, 3) with the normals of planes through their neighbours.

    They face away from the middle of the cloud, which suits compact bodies only. Raises ValueError
    for too few points.
    """
    if len(points) < 100:
        raise ValueError(f"a cloud of {len(points)} points is too thin; 100 are needed at least")
    near = points[scipy.spatial.cKDTree(points).query(points, k=_NEIGHBOURS)[1]]
    centred = near - near.mean(axis=1, keepdims=True)
    normals = np.linalg.eigh(np.swapaxes(centred, 1, 2) @ centred)[1][..., 0]
    outward = np.sign(((points - points.mean(axis=0)) * normals).sum(axis=1))
    return OrientedCloud(points, normals * np.where(outward < 0.0, -1.0, 1.0)[:, None])
