"""How much of a surface the images show."""

import numpy as np
import scipy

from debrisest.arrays import Array, BoolArray
from debrisest.reconstruction.closed_mesh import ClosedMesh
from debrisest.reconstruction.dense_cloud import OrientedCloud
from debrisest.vision.polyhedron import face_normals

_NEIGHBOURS = 8
_ALIKE = 0.3
"""Least cosine between the normals of a triangle and of a point that shows it."""


def triangles_seen(mesh: ClosedMesh, cloud: OrientedCloud, reach: float) -> BoolArray:
    """Return which triangles have points of the cloud within a distance that face the same way."""
    normals, area = _normals(mesh)
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    near, index = scipy.spatial.cKDTree(cloud.points).query(middles, k=_NEIGHBOURS)
    alike = np.einsum("ti,tki->tk", normals, cloud.normals[index])
    alike /= np.maximum(area, 1e-30)[:, None]
    return np.asarray(((near < reach) & (alike > _ALIKE)).any(axis=1))


def share_of_area(mesh: ClosedMesh, chosen: BoolArray) -> float:
    """Return the share that chosen triangles have of a mesh's area."""
    area = _normals(mesh)[1]
    return float(area[chosen].sum() / area.sum())


def _normals(mesh: ClosedMesh) -> tuple[Array, Array]:
    """Return vectors along the triangles' normals, and their lengths: twice the areas."""
    normals = face_normals(mesh.vertices[mesh.triangles])
    return normals, np.linalg.norm(normals, axis=1)
