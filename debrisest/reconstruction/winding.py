"""Faces of a mesh made to agree on which side is outside, and on which solid they belong to."""

from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array, IntArray


class Wound(NamedTuple):
    """Triangles that agree with their neighbours, and what was turned for it."""

    triangles: IntArray
    """(triangle, 3)."""
    piece: IntArray
    """(triangle,), the number of the connected piece that each belongs to."""
    turned: int
    """How many triangles were turned."""


def edges_of(triangles: IntArray) -> IntArray:
    """Return the directed edges (3 triangle, 2): all first ones, all second, all third."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


def faces_on_edges(triangles: IntArray) -> IntArray:
    """Return the number of triangles on each edge (edge,)."""
    return np.unique(np.sort(edges_of(triangles), axis=1), axis=0, return_counts=True)[1]


def pieces_of(triangles: IntArray) -> IntArray:
    """Return the number of the connected piece that each triangle belongs to (triangle,)."""
    joined = (np.ones(3 * len(triangles)), edges_of(triangles).T)
    label = scipy.sparse.csgraph.connected_components(
        scipy.sparse.coo_array(joined, shape=2 * (triangles.max() + 1,))
    )[1]
    return np.unique(label[triangles[:, 0]], return_inverse=True)[1].astype(np.int64)


def wound_alike(triangles: IntArray) -> Wound:
    """Turn triangles until neighbours agree; every edge has just two of them.

    The majority of each piece stays as it is. A graph with two nodes for each triangle, as it is
    and turned, joins what agrees. Raises ValueError for a surface with one side only.
    """
    count = len(triangles)
    edges = edges_of(triangles)
    order = np.lexsort(np.sort(edges, axis=1).T)
    face = np.tile(np.arange(count), 3)[order].reshape(-1, 2)
    first, second = edges[order].reshape(-1, 2, 2).swapaxes(0, 1)
    twist = np.where((first == second).all(axis=1), count, 0)
    one, other = face.T
    rows = np.concatenate([one, one + count])
    columns = np.concatenate([(other + twist), (other + count + twist) % (2 * count)])
    graph = scipy.sparse.coo_array(
        (np.ones(len(rows)), (rows, columns)), shape=(2 * count, 2 * count)
    )
    label = scipy.sparse.csgraph.connected_components(graph, directed=False)[1].astype(np.int64)
    straight, turned = label[:count], label[count:]
    if (straight == turned).any():
        raise ValueError("the surface has one side only, as a Moebius strip has; it bounds no body")
    piece = np.unique(np.minimum(straight, turned), return_inverse=True)[1]
    minority = _minority(straight, turned, piece)
    alike = np.where(minority[:, None], triangles[:, ::-1], triangles)
    return Wound(alike, piece, int(minority.sum()))


def _minority(straight: IntArray, turned: IntArray, piece: IntArray) -> Array:
    """Return which triangles to turn: in each piece, those of the smaller party."""
    party = straight < turned
    share = np.bincount(piece, party) / np.bincount(piece)
    return np.asarray(np.where(share[piece] >= 0.5, ~party, party))


def winding_number(point: Array, corners: Array) -> float:
    """Return how often closed triangles (triangle, 3, 3) go around a point (3,): 1 inside.

    Sum of solid angles, van Oosterom and Strackee 1983.
    """
    a, b, c = np.moveaxis(corners - point, 1, 0)
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=1)
    rest = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return float(np.arctan2(volume, rest).sum() / (2.0 * np.pi))
