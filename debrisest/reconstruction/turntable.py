"""The table on which a body turns: images taken from above it never show the body's base.

Silhouettes from above leave a cone below the base. A body that turned about one axis only, before
a camera that looks down on it, is taken to stand on a plane at a right angle to this axis, through
the lowest points that are seen.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.structure import Structure

_ONE_AXIS, _TURNED = np.sin(np.radians(2.0)), np.sin(np.radians(20.0))
"""Most that the axis moves, least that what is across it does: RMS over the images."""
_LOOKS_DOWN = np.sin(np.radians(4.0))
_LOWEST = 0.005
"""Share of the points that lie below the base, by their errors."""
_DEEPEST_PX, _CLOSING = 16, 0.85
"""How far below the lowest points a base is looked for; share of their area where it closes."""
_FITS = 3
_LAYER, _SUPPORT, _BELOW = 0.05, 0.15, 0.05
"""A support's points: how thick they lie, of the height of all; least share; most share below."""


class Table(NamedTuple):
    """A plane in the axes r of the structure."""

    up: Array
    """Unit vector (3,) along the axis of the turn, towards the camera's side."""
    height: float
    """Of the plane along it."""

    def below(self, points: Array) -> Array:
        """Return how far points (n, 3) lie below the table (n,)."""
        return np.asarray(self.height - points @ self.up)


def table_under(points: Array, structure: Structure) -> Table | None:
    """Return the table under points (point, 3) of the body's surface.

    None where the body turned about more than one axis, or little, or was not looked down upon.
    """
    up = _upwards(points, structure)
    return None if up is None else Table(up, float(np.quantile(points @ up, _LOWEST)))


def lowered(table: Table, points: Array, outside: Callable[[Array], Any], pixel: float) -> Table:
    """Return the table where silhouettes begin to close below the lowest points that are seen.

    Depth ends some pixels within an outline, so that these points lie above the base.
    ``outside(points)`` tells how far points (n, 3) are outside of silhouettes, ``points`` are the
    body's, a ``pixel`` is what it makes at the body.
    """
    across = np.linalg.svd(table.up[None])[2][1:]
    flat = points @ across.T
    ranges = [np.arange(*ends, pixel) for ends in zip(flat.min(axis=0), flat.max(axis=0))]
    level = np.stack(np.meshgrid(*ranges), axis=-1).reshape(-1, 2) @ across
    area = [
        np.sum(outside(level + (table.height - step * pixel) * table.up) < 0.0)
        for step in range(_DEEPEST_PX)
    ]
    closing = np.flatnonzero(np.array(area) < _CLOSING * area[0])
    steps = int(closing[0]) - 1 if len(closing) else 0
    return table._replace(height=table.height - max(steps, 0) * pixel)


def support_of(structure: Structure) -> Table | None:
    """Return the table that turns with the body and has points of its own, as a patterned one has.

    They lie in a layer across the axis, below nearly all others, and reach as far from the axis as
    those. The table is the plane through them, less three sigma of what they leave. None where
    there is no such layer.
    """
    points = structure.points
    up = _upwards(points, structure)
    if up is None:
        return None
    height = points @ up
    width = _LAYER * float(np.subtract(*np.quantile(height, [0.99, 0.01])))
    ordered = np.sort(height)
    inside = np.searchsorted(ordered, ordered + width) - np.arange(len(ordered))
    first = int(inside.argmax())
    layer = (height >= ordered[first]) & (height <= ordered[first] + width)
    across = points - height[:, None] * up
    away = np.linalg.norm(across - np.median(across[~layer], axis=0), axis=1)
    wide = np.quantile(away[layer], 0.9) > np.quantile(away[~layer], 0.9)
    if layer.mean() < _SUPPORT or first > _BELOW * len(points) or not wide:
        return None
    return _plane(points[layer], up)


def _plane(points: Array, up: Array) -> Table:
    """Return the plane through most of the points (point, 3), from its upper side."""
    height = points @ up
    for _ in range(_FITS):
        off = height - np.median(height)
        sigma = 1.4826 * float(np.median(np.abs(off)))
        near = points[np.abs(off) < 3.0 * sigma]
        normal = np.linalg.svd(near - near.mean(axis=0), full_matrices=False)[2][2]
        normal *= np.sign(normal @ up)
        height = points @ normal
    return Table(normal, float(np.median(height)) + 3.0 * sigma)


def _upwards(points: Array, structure: Structure) -> Array | None:
    """Return the unit vector along the one axis of the turn, towards the camera's side."""
    placed = structure.registered
    turns, shifts = structure.rotation[placed], structure.translation[placed]
    off = turns - turns.mean(axis=0)
    moved, axes = np.linalg.eigh(np.einsum("tji,tjk->ik", off, off) / len(placed))
    moved = np.sqrt(np.maximum(moved, 0.0))
    if moved[0] > _ONE_AXIS or moved[1] < _TURNED:
        return None
    away = -np.einsum("tji,tj->ti", turns, shifts) - np.median(points, axis=0)
    elevation = float(np.median(away @ axes[:, 0] / np.linalg.norm(away, axis=1)))
    if abs(elevation) < _LOOKS_DOWN:
        return None
    return np.asarray(axes[:, 0] * np.sign(elevation))
