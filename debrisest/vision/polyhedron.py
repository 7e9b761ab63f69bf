"""Faces and mass properties of triangle meshes, the latter by sums over tetrahedra.

Source: the divergence theorem; second moments of a tetrahedron as in Tonon 2004.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray


class MassProperties(NamedTuple):
    """Of a body of density one."""

    volume: float
    """m3."""
    centre: Array
    """Centre of mass (3,), m."""
    inertia: Array
    """Tensor (3, 3) about the centre of mass, m5."""


def face_normals(corners: Array) -> Array:
    """Return vectors along the outward normals of triangles (..., 3, 3), twice their areas long."""
    first, second, third = np.moveaxis(corners, -2, 0)
    return np.cross(second - first, third - first)


def mass_properties(vertices: Array, triangles: IntArray) -> MassProperties:
    """Return those of a mesh: ``vertices (vertex, 3)``, m, ``triangles (triangle, 3)`` of them.

    Triangles are counterclockwise seen from outside. The mesh is taken to be closed; several
    closed meshes that do not overlap may be in one. Nothing is checked.
    """
    middle = vertices.mean(axis=0)
    corners = (vertices - middle)[triangles]
    sixfold = np.linalg.det(corners)
    total = corners.sum(axis=1)
    volume = sixfold.sum() / 6.0
    first = (sixfold @ total) / 24.0
    outer = np.einsum("ti,tj->tij", total, total) + np.einsum("tci,tcj->tij", corners, corners)
    centre = first / volume
    second = np.einsum("t,tij->ij", sixfold, outer) / 120.0 - volume * np.outer(centre, centre)
    inertia = np.trace(second) * np.eye(3) - second
    return MassProperties(float(volume), middle + centre, inertia)
