"""A pattern that fills space, so that a surface has the same look from wherever it is seen."""

import numpy as np
import scipy

from debrisest.arrays import Array

_OCTAVES = 5
_PERIOD = 32
_CONTRAST = 3.0
"""Of the edges between bright and dark."""


class SolidNoise:
    """Sums of noise on lattices, each twice as fine as the one before, between 0 and 1."""

    def __init__(self, seed: int, grain: float) -> None:
        self._lattices = np.random.default_rng(seed).random((_OCTAVES, *3 * (_PERIOD,))) - 0.5
        self._grain = grain

    def __call__(self, points: Array) -> Array:
        """Return the pattern (n,) at points (n, 3), m; the coarsest spots are a grain wide."""
        total = np.zeros(len(points))
        for octave, lattice in enumerate(self._lattices):
            place = (points * (2.0**octave / self._grain) + 0.37 * octave).T
            total += 0.75**octave * scipy.ndimage.map_coordinates(
                lattice, place, order=1, mode="grid-wrap"
            )
        return np.asarray(0.5 + 0.5 * np.tanh(_CONTRAST * total))
