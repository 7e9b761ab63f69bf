"""Error bars of a body from images: scale, resolution, depth, and what was never seen.

The 1-sigma is the root of the sum of squares of four: that of the scale (three times it for the
volume, five times for the inertia); what a coarser resolution changes; what a surface changes all
of whose points are closer or farther by a twentieth of a pixel of disparity, as matching is off
where grey levels do not follow the texture alone; and surface that no image shows, which is taken
to be off by a third of its distance from the centre, its share for the volume and 5/3 of it for the
inertia.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.closed_mesh import ClosedMesh
from debrisest.reconstruction.depth import DepthView
from debrisest.vision.polyhedron import MassProperties, face_normals, mass_properties

TENSOR = ((0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2))
"""Rows and columns of the components xx, yy, zz, xy, xz, yz."""
DISPARITY_PX = 0.05
"""1-sigma of what all disparities of a surface are off together."""
_LENGTHS = np.array([3.0, *3 * [0.0], *3 * [5.0], *3 * [0.0]])
"""Powers of the length in volume, centre and inertia of density one, as far as it scales them."""
_UNSEEN = np.array([1.0, *3 * [1.0 / 3.0], *6 * [5.0 / 3.0]])


class Doubts(NamedTuple):
    """What is not known of a surface."""

    scale: float
    """1-sigma of the scale, of it; infinite: there is none, and nothing is told of it."""
    depth: float
    """1-sigma of what all of the surface is off along its normals, m."""
    unseen: float
    """Share of the surface that no image shows."""


def packed(properties: MassProperties) -> Array:
    """Return volume, centre and inertia xx, yy, zz, xy, xz, yz as one vector (10,)."""
    return np.array([properties.volume, *properties.centre, *properties.inertia[TENSOR]])


def depth_sigma(views: Sequence[DepthView]) -> float:
    """Return the 1-sigma, m, of what all depths of a body are off together."""
    return DISPARITY_PX * float(np.median([each.pixel_m for each in views]))


def error_bars(fine: ClosedMesh, coarse: ClosedMesh, doubts: Doubts) -> Array:
    """Return the 1-sigma (10,) of volume, centre and inertia of the finer mesh."""
    found = mass_properties(fine.vertices, fine.triangles)
    told, size = packed(found), np.sqrt(np.trace(found.inertia) / (2.0 * found.volume))
    moments = np.diag(found.inertia)
    level = np.sqrt(moments[list(TENSOR[0])] * moments[list(TENSOR[1])])
    whole = np.array([found.volume, *3 * [size], *level])
    others = (coarse.vertices, coarse.triangles), (_outwards(fine, doubts.depth), fine.triangles)
    changed = [packed(mass_properties(*other)) - told for other in others]
    known = doubts.scale if np.isfinite(doubts.scale) else 0.0
    parts = (*changed, whole * _LENGTHS * known, whole * _UNSEEN * doubts.unseen)
    return np.asarray(np.linalg.norm(parts, axis=0))


def _outwards(mesh: ClosedMesh, distance: float) -> Array:
    """Return the vertices (vertex, 3) of a mesh moved along their normals."""
    faces = face_normals(mesh.vertices[mesh.triangles])
    normals = np.zeros_like(mesh.vertices)
    for corner in mesh.triangles.T:
        np.add.at(normals, corner, faces)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return np.asarray(mesh.vertices + distance * normals / np.maximum(length, 1e-30))
