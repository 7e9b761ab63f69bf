"""Closed triangle meshes of simple solids, counterclockwise seen from outside."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray

_FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


class Solid(NamedTuple):
    """A closed mesh: ``vertices (vertex, 3)``, m, ``triangles (triangle, 3)``, their albedo."""

    vertices: Array
    triangles: IntArray
    albedo: Array
    """(triangle,), between 0 and 1."""


def box(centre: Sequence[float], sides: Sequence[float], albedo: float) -> Solid:
    """Return a box with sides along the axes."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    squares = np.array(_FACES)
    triangles = np.concatenate([squares[:, [0, 2, 1]], squares[:, [0, 3, 2]]])
    vertices = np.array(centre) + 0.5 * corners * np.array(sides)
    return Solid(vertices, triangles, np.full(len(triangles), albedo))


def revolved(profile: Sequence[tuple[float, float]], albedo: float, sections: int = 128) -> Solid:
    """Return a solid about the z axis from its ``(radius, z)``, upwards, from axis to axis.

    The first and the last radius are zero, no other is.
    """
    angle = 2.0 * np.pi * np.arange(sections) / sections
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(sections)], axis=-1)
    rings = [radius * circle + [0.0, 0.0, z] for radius, z in profile[1:-1]]
    ends = [[0.0, 0.0, profile[0][1]], [0.0, 0.0, profile[-1][1]]]
    here, after = np.arange(sections), np.roll(np.arange(sections), -1)
    last, bottom = sections * (len(rings) - 1), sections * len(rings)
    triangles = [np.stack([np.full(sections, bottom), after, here], axis=-1)]
    for low in range(0, last, sections):
        high = low + sections
        triangles += [
            np.stack([low + here, low + after, high + after], axis=-1),
            np.stack([low + here, high + after, high + here], axis=-1),
        ]
    triangles += [np.stack([np.full(sections, bottom + 1), last + here, last + after], axis=-1)]
    faces = np.concatenate(triangles)
    return Solid(np.concatenate([*rings, ends]), faces, np.full(len(faces), albedo))


def joined(*solids: Solid) -> Solid:
    """Return solids that do not overlap as one mesh."""
    starts = np.cumsum([0, *(len(solid.vertices) for solid in solids[:-1])])
    return Solid(
        np.concatenate([solid.vertices for solid in solids]),
        np.concatenate([solid.triangles + start for solid, start in zip(solids, starts)]),
        np.concatenate([solid.albedo for solid in solids]),
    )


def turned(solid: Solid, rotation: Array, shift: Sequence[float] = (0.0, 0.0, 0.0)) -> Solid:
    """Return a solid turned by a rotation (3, 3), then moved."""
    return solid._replace(vertices=solid.vertices @ rotation.T + np.array(shift))
