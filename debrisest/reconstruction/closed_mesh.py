"""The guard before mass properties: a mesh that bounds a body, mended where that is safe.

Formulas for mass properties answer for any triangles; here a mesh is refused with a count of what
is wrong, or mended with a count of what was. A shell that is wound inwards within another one is a
cavity.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.reconstruction.crossings import crossing_pairs
from debrisest.reconstruction.union import union
from debrisest.reconstruction.winding import faces_on_edges, winding_number, wound_alike
from debrisest.vision.polyhedron import face_normals, mass_properties

_SAME = 1e-9
"""Vertices nearer than this, of the mesh's size, are one."""
_FLAT = 1e-7
"""Of the volume of a ball with the same area: less is no body."""


class ClosedMesh(NamedTuple):
    """A mesh that bounds a body."""

    vertices: Array
    """(vertex, 3), m."""
    triangles: IntArray
    """(triangle, 3), counterclockwise from outside."""
    mended: tuple[str, ...] = ()
    """What was wrong with it, with counts, in words."""


def closed_mesh(vertices: Array, triangles: IntArray, of_voxels: bool = False) -> ClosedMesh:
    """Return the mesh, mended where needed; ``vertices (vertex, 3)``, ``triangles (triangle, 3)``.

    Mended: vertices and faces that are there more than once, faces without area, faces wound the
    other way, a solid that is inside out, solids that overlap. Raises ValueError, with counts, for
    a mesh that is open, flat or passes through itself, for an edge of more than two faces, and for
    an inertia that no body has. The surface ``of_voxels`` cannot cross another or itself, so that
    this is not looked for, which takes minutes where there are hundreds of thousands of faces.
    """
    vertices, triangles, mended = _without_copies(*_merged(vertices, triangles))
    _require_closed(vertices, triangles)
    wound = wound_alike(triangles)
    if wound.turned:
        mended.append(f"{_many(wound.turned, 'face')} wound the other way: turned")
    triangles, flipped = _outward(vertices, wound.triangles, wound.piece)
    if flipped:
        mended.append(f"{_many(flipped, 'solid')} inside out: turned")
    mesh, said = ClosedMesh(vertices, triangles), list[str]()
    if not of_voxels:
        mesh, said = _without_overlaps(vertices, triangles, wound.piece)
    _require_body(mesh)
    return mesh._replace(mended=(*mended, *said))


def _many(count: int, thing: str) -> str:
    return f"{count} {thing}" if count == 1 else f"{count} {thing}s"


def _merged(vertices: Array, triangles: IntArray) -> tuple[Array, IntArray]:
    """Return the mesh with each used vertex once."""
    if not len(triangles):
        raise ValueError("the mesh has no faces")
    if not np.isfinite(vertices).all():
        raise ValueError("the mesh has vertices that are not finite")
    size = np.ptp(vertices, axis=0).max() or 1.0
    rounded = np.round(vertices / (_SAME * size)).astype(np.int64)
    _, first, number = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    used, new = np.unique(number.reshape(-1)[triangles], return_inverse=True)
    return vertices[first][used], new.reshape(triangles.shape).astype(np.int64)


def _without_copies(vertices: Array, triangles: IntArray) -> tuple[Array, IntArray, list[str]]:
    """Remove faces without area; of equal faces keep one, of two that face each other none."""
    a, b, c = triangles.T
    sound = (a != b) & (b != c) & (c != a)
    said = [f"{_many(int((~sound).sum()), 'face')} without area: removed"] * (not sound.all())
    whole = triangles[sound]
    ordered = np.sort(whole, axis=1)
    parity = np.sign(
        (whole[:, 1] - whole[:, 0]) * (whole[:, 2] - whole[:, 1]) * (whole[:, 2] - whole[:, 0])
    )
    _, first, group = np.unique(ordered, axis=0, return_index=True, return_inverse=True)
    net = np.bincount(group.reshape(-1), parity)
    kept = np.where(net[:, None] < 0, ordered[first][:, ::-1], ordered[first])[net != 0]
    if copies := len(whole) - len(kept):
        said.append(f"{_many(copies, 'face')} there more than once: removed")
    if not len(kept):
        raise ValueError("the mesh is flat: every face has another one that faces it")
    return vertices, kept if copies else whole, said


def _require_closed(vertices: Array, triangles: IntArray) -> None:
    counts = faces_on_edges(triangles)
    if lonely := int((counts == 1).sum()):
        have = "edge has" if lonely == 1 else "edges have"
        raise ValueError(
            f"the mesh is not closed: {lonely} {have} one face only; fill the holes first"
        )
    if crowded := int((counts > 2).sum()):
        have = "edge has" if crowded == 1 else "edges have"
        raise ValueError(
            f"{crowded} {have} more than two faces; separate the solids that meet there"
        )
    corners = vertices[triangles]
    if np.linalg.matrix_rank(vertices - vertices.mean(axis=0), tol=_FLAT * np.ptp(corners)) < 3:
        raise ValueError("the mesh is flat: all vertices lie in a plane; it has no volume")


def _outward(vertices: Array, triangles: IntArray, piece: IntArray) -> tuple[IntArray, int]:
    """Turn solids that are inside out, unless they are cavities; return how many were."""
    pieces = [vertices[triangles[piece == number]] for number in range(piece.max() + 1)]
    volume = np.array([np.linalg.det(each - vertices.mean(axis=0)).sum() for each in pieces])
    inverse = volume * np.sign(volume.sum()) < 0.0
    inside = np.array([_is_within(number, pieces) for number in range(len(pieces))])
    outward = np.where(inside & inverse, -1.0, 1.0)
    wrong = np.sign(volume) == -outward
    return np.where(wrong[piece][:, None], triangles[:, ::-1], triangles), int(wrong.sum())


def _is_within(number: int, pieces: list[Array]) -> bool:
    point = pieces[number][0, 0]
    others = (other for index, other in enumerate(pieces) if index != number)
    return any(abs(winding_number(point, other)) > 0.75 for other in others)


def _without_overlaps(
    vertices: Array, triangles: IntArray, piece: IntArray
) -> tuple[ClosedMesh, list[str]]:
    """Return the union of solids that overlap; ValueError for one that passes through itself."""
    owner = piece[crossing_pairs(vertices, triangles)]
    alone = owner[:, 0] == owner[:, 1]
    if alone.any():
        raise ValueError(
            f"the surface passes through itself: {_many(int(alone.sum()), 'pair')} of faces cross; "
            "repair it in the program that made it"
        )
    pieces = [triangles[piece == number] for number in range(piece.max() + 1)]
    overlapping = set(owner.ravel().tolist()) | _swallowed(vertices, pieces)
    if not overlapping:
        return ClosedMesh(vertices, triangles), []
    before = mass_properties(vertices, triangles).volume
    mesh = ClosedMesh(*union(vertices, pieces))
    after = mass_properties(mesh.vertices, mesh.triangles).volume
    said = f"{_many(len(overlapping), 'solid')} overlapping others: united, volume "
    return mesh, [f"{said}{before:.6g} to {after:.6g} m3"]


def _swallowed(vertices: Array, pieces: list[IntArray]) -> set[int]:
    """Return the solids, no cavities, that lie within another one with no cavity between."""
    corners = [vertices[piece] for piece in pieces]
    result = set()
    for number, each in enumerate(corners):
        others = (other for index, other in enumerate(corners) if index != number)
        around = sum(winding_number(each[0, 0], other) for other in others)
        solid = np.linalg.det(each - each.mean(axis=(0, 1))).sum() > 0.0
        if solid and around > 0.5:
            result.add(number)
    return result


def _require_body(mesh: ClosedMesh) -> None:
    """Raise ValueError for a volume or an inertia that no body has."""
    normals = face_normals(mesh.vertices[mesh.triangles])
    area = np.linalg.norm(normals, axis=1).sum() / 2.0
    found = mass_properties(mesh.vertices, mesh.triangles)
    if found.volume < _FLAT * area**1.5 / (6.0 * np.sqrt(np.pi)):
        raise ValueError(f"the mesh is flat: its volume is {found.volume:.3g} m3")
    moments = np.linalg.eigvalsh(found.inertia)
    if not (moments[0] > 0.0 and moments[0] + moments[1] >= moments[2] * (1.0 - 1e-9)):
        told = ", ".join(f"{moment:.4g}" for moment in moments)
        raise ValueError(
            f"no body has principal moments {told}: the largest exceeds the sum of the others; "
            "is a cavity outside of its solid?"
        )
