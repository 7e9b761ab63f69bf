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
def factor(matrix: Array) -> None:
    """Replace a positive matrix (n, n), from its diagonal on, by R of ``R^T D^-1 R``.

    D is the diagonal of R, which is zero below it; what is there is left as it was.
    """
    n = len(matrix)
    for i in range(n):
        for k in range(0, i - 3, 4):
            a, b = matrix[k, i] / matrix[k, k], matrix[k + 1, i] / matrix[k + 1, k + 1]
            c, d = matrix[k + 2, i] / matrix[k + 2, k + 2], matrix[k + 3, i] / matrix[k + 3, k + 3]
            for j in range(i, n):
                two = a * matrix[k, j] + b * matrix[k + 1, j]
                matrix[i, j] -= two + (c * matrix[k + 2, j] + d * matrix[k + 3, j])
        for k in range(i - i % 4, i):
            a = matrix[k, i] / matrix[k, k]
            for j in range(i, n):
                matrix[i, j] -= a * matrix[k, j]


@compiled
def factor_solve(factors: Array, right: Array) -> None:
    """Replace a right side (n) by the solution, by what `factor` gives."""
    n = len(right)
    for k in range(n):
        share = right[k] / factors[k, k]
        for i in range(k + 1, n):
            right[i] -= share * factors[k, i]
    for k in range(n - 1, -1, -1):
        for i in range(k + 1, n):
            right[k] -= factors[k, i] * right[i]
        right[k] /= factors[k, k]


@compiled
def factor_inverse(factors: Array, inverse: Array) -> None:
    """Write the inverse (n, n), by what `factor` gives."""
    n = len(factors)
    root = np.zeros((n, n))
    inverse[:] = 0.0
    for i in range(n):
        root[i, i] = 1.0
        for k in range(i):
            share = factors[k, i] / factors[k, k]
            for j in range(k + 1):
                root[i, j] -= share * root[k, j]
    for i in range(n):
        for k in range(i, n):
            share = root[k, i] / factors[k, k]
            for j in range(i + 1):
                inverse[i, j] += share * root[k, j]
        for j in range(i):
            inverse[j, i] = inverse[i, j]


@compiled
def mirror(matrix: Array) -> None:
    """Write what is below the diagonal from what is above it."""
    for a in range(len(matrix)):
        for b in range(a):
            matrix[a, b] = matrix[b, a]


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
