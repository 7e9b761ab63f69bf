"""Triangles of a mesh that pass through each other."""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray

_CHUNK = 2_000_000
_INSIDE = 1e-9
"""How far within the other triangle an edge has to pass, of the triangle's size."""


def crossing_pairs(vertices: Array, triangles: IntArray) -> IntArray:
    """Return the pairs of triangles (pair, 2) of which an edge of one passes through the other.

    Triangles that touch, share an edge or lie in one plane do not cross.
    """
    corners = vertices[triangles]
    found = [
        pairs[_pierces(pairs, vertices, triangles)]
        for near in _boxes_that_meet(corners.min(axis=1), corners.max(axis=1))
        for pairs in (near, near[:, ::-1])
    ]
    crossing = np.concatenate([np.empty((0, 2), dtype=np.int64), *found])
    return np.unique(np.sort(crossing, axis=1), axis=0)


def _boxes_that_meet(lowest: Array, highest: Array) -> list[IntArray]:
    """Return pairs (pair, 2) of boxes (box, 3) that meet, in portions: a sweep along x."""
    order = np.argsort(lowest[:, 0])
    lowest, highest = lowest[order], highest[order]
    last = np.searchsorted(lowest[:, 0], highest[:, 0], side="right")
    counts = last - np.arange(len(order)) - 1
    portions = np.searchsorted(np.cumsum(counts), np.arange(0, counts.sum(), _CHUNK))
    result = []
    for begin, end in zip(portions, [*portions[1:], len(order)]):
        first = np.repeat(np.arange(begin, end), counts[begin:end])
        starts = np.cumsum(counts[begin:end]) - counts[begin:end]
        second = first + 1 + np.arange(len(first)) - np.repeat(starts, counts[begin:end])
        meet = (lowest[second, 1:] <= highest[first, 1:]).all(axis=1)
        meet &= (lowest[first, 1:] <= highest[second, 1:]).all(axis=1)
        result.append(order[np.stack([first[meet], second[meet]], axis=1)])
    return result


def _pierces(pairs: IntArray, vertices: Array, triangles: IntArray) -> BoolArray:
    """Return for each pair whether an edge of the first passes through the second."""
    a, b, c = np.moveaxis(vertices[triangles[pairs[:, 1]]], 1, 0)
    result = np.zeros(len(pairs), dtype=np.bool_)
    for one, other in ((0, 1), (1, 2), (2, 0)):
        ends = triangles[pairs[:, 0]][:, [one, other]]
        apart = ~(ends[:, :, None] == triangles[pairs[:, 1]][:, None]).any(axis=(1, 2))
        p, q = vertices[ends[:, 0]], vertices[ends[:, 1]]
        sides = np.stack([_volume(p, q, a, b), _volume(p, q, b, c), _volume(p, q, c, a)])
        size = np.linalg.norm(np.cross(b - a, c - a), axis=1) * np.linalg.norm(q - p, axis=1)
        across = _volume(p, a, b, c) * _volume(q, a, b, c) < -((_INSIDE * size) ** 2)
        within = (sides > _INSIDE * size).all(axis=0) | (sides < -_INSIDE * size).all(axis=0)
        result |= apart & across & within
    return result


def _volume(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Return six times the signed volumes of tetrahedra."""
    return np.asarray((np.cross(b - a, c - a) * (d - a)).sum(axis=1))
