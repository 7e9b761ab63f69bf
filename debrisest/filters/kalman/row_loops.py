"""Sums of weighted rows of matrices, for compiled loops.

Four rows at a time, since what is added to is read and written once for them; indices without a
sign let a loop over part of a row become vectors.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

BLOCK = 16
"""Columns of a root that are updated together."""


@compiled
def add_products(
    to: Array,
    at: int,
    rows: Array,
    weights: Array,
    of: int,
    first: int,
    end: int,
    start: int,
    sign: float,
) -> None:
    """Add some rows, by a row of weights, to the row ``at``, from its start on."""
    for c in range(first, end - 3, 4):
        s, t = sign * weights[of, c], sign * weights[of, c + 1]
        u, v = sign * weights[of, c + 2], sign * weights[of, c + 3]
        for r in range(np.uint64(start), np.uint64(to.shape[1])):
            to[at, r] += (s * rows[c, r] + t * rows[c + 1, r]) + (
                u * rows[c + 2, r] + v * rows[c + 3, r]
            )
    for c in range(end - (end - first) % 4, end):
        s = sign * weights[of, c]
        for r in range(np.uint64(start), np.uint64(to.shape[1])):
            to[at, r] += s * rows[c, r]


@compiled
def add_blocks(
    to: Array, at: int, rows: Array, weights: Array, of: int, first: int, end: int, sign: float
) -> None:
    """Do the same where rows are as long as a block."""
    for c in range(first, end - 3, 4):
        s, t = sign * weights[of, c], sign * weights[of, c + 1]
        u, v = sign * weights[of, c + 2], sign * weights[of, c + 3]
        for r in range(BLOCK):
            to[at, r] += (s * rows[c, r] + t * rows[c + 1, r]) + (
                u * rows[c + 2, r] + v * rows[c + 3, r]
            )
    for c in range(end - (end - first) % 4, end):
        s = sign * weights[of, c]
        for r in range(BLOCK):
            to[at, r] += s * rows[c, r]
