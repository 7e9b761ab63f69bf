"""Points that are followed through images."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray


class Followed(NamedTuple):
    """What is followed now: the points' numbers (n,) and pixels (n, 2) or (n, camera, 2)."""

    numbers: IntArray
    pixels: Array

    def kept(self, which: BoolArray) -> "Followed":
        """Return some of them."""
        return Followed(self.numbers[which], self.pixels[which])

    def and_more(self, numbers: IntArray, pixels: Array) -> "Followed":
        """Return them and others."""
        return Followed(
            np.concatenate([self.numbers, numbers]), np.concatenate([self.pixels, pixels])
        )


def nothing(*cameras: int) -> Followed:
    """Return no points, with pixels (0, *cameras, 2)."""
    return Followed(np.zeros(0, dtype=np.int64), np.zeros((0, *cameras, 2)))
