"""What bounds a body from outside: its silhouettes in all images, and the table it stands on."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.reconstruction import fusion
from debrisest.reconstruction.structure import Structure
from debrisest.reconstruction.turntable import Table, lowered

_NEXT_PX = 2.0


class Outer(NamedTuple):
    """Silhouettes of the first camera (time, row, column), its matrix and its places; a table."""

    masks: BoolArray
    matrix: Array
    structure: Structure
    table: Table | None = None

    def outside(self, points: Array | fusion.Values) -> fusion.Values:
        """Return how far points (n, 3) lie outside of silhouettes, or below the table (n,), m."""
        found = fusion.outside_silhouettes(points, self.masks, self.matrix, self.structure)
        if self.table is None:
            return found
        return np.maximum(found, self.table.below(np.asarray(points, float)).astype(np.float32))

    def on(self, table: Table | None) -> "Outer":
        """Return the same on a table, as low as the silhouettes let it be."""
        if table is None:
            return self
        low = lowered(table, self.structure.points, self.outside, self.pixel)
        return self._replace(table=low)

    @property
    def pixel(self) -> float:
        """Return what a pixel makes at the body, m."""
        away = self.structure.translation[self.structure.registered]
        return float(np.median(np.linalg.norm(away, axis=1)) / self.matrix[0, 0])

    def holds(self, points: Array) -> BoolArray:
        """Return which points (n, 3) lie in the silhouettes, or next to them."""
        return np.asarray(self.outside(points) < _NEXT_PX * self.pixel)

    def volume(self, voxel: float) -> float:
        """Return the volume of what all silhouettes share."""
        grid = fusion.grid_about(self.structure.points, voxel)
        return float((self.outside(grid.points) < 0.0).sum() * voxel**3)
