"""Linear algebra of one small positive matrix, for compiled loops.

Indices without a sign let a loop over part of a row become vectors.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def solve(matrix: Array, right: Array) -> None:
    """Replace the right side (n) of a positive system (n, n) by its solution; spoils the matrix."""
    for k in range(len(right)):
        for i in range(k + 1, len(right)):
            share = matrix[k, i] / matrix[k, k]
            right[i] -= share * right[k]
            for j in range(i, len(right)):
                matrix[i, j] -= share * matrix[k, j]
    for k in range(len(right) - 1, -1, -1):
        for i in range(k + 1, len(right)):
            right[k] -= matrix[k, i] * right[i]
        right[k] /= matrix[k, k]


@compiled
def cholesky(matrix: Array, upper: Array, lower: Array) -> None:
    """Write the upper triangular U, ``U^T U`` the matrix (n, n), and its transpose.

    Only what is on and above the diagonal of the matrix is looked at, and of U written.
    """
    n = len(matrix)
    for k in range(n):
        for j in range(np.uint64(k), np.uint64(n)):
            upper[k, j] = matrix[k, j]
        add_products(upper, k, upper, lower, k, 0, k, k, -1.0)
        scale = 1.0 / np.sqrt(upper[k, k])
        for j in range(np.uint64(k), np.uint64(n)):
            upper[k, j] *= scale
            lower[j, k] = upper[k, j]


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
    """Add rows from the first to the end, by a row of weights, to row ``at``, from its start on.

    Four at a time, since what is added to is then read and written once for them.
    """
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
