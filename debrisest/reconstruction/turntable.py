"""The table on which a body turns: images taken from above it never show the body's base.

Silhouettes from above leave a cone below the base. A body that turned about one axis only, before
a camera that looks down on it, is taken to stand on a plane at a right angle to this axis, through
the lowest points that are seen.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.structure import Structure

_ONE_AXIS, _TURNED = np.sin(np.radians(2.0)), np.sin(np.radians(20.0))
"""Most that the axis moves, least that what is across it does: RMS over the images."""
_LOOKS_DOWN = np.sin(np.radians(4.0))
_LOWEST = 0.005
"""Share of the points that lie below the base, by their errors."""


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
    up = axes[:, 0] * np.sign(elevation)
    return Table(up, float(np.quantile(points @ up, _LOWEST)))
