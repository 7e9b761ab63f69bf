"""Information gathered epoch by epoch as plain loops, for `debrisest.compiled`."""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.linear_algebra_loops import add_products, cholesky


@compiled
def gathered(
    information: Array, gradient: Array, rows: Array, residual: Array, moved: Array
) -> tuple[Array, Array, Array]:
    """Add to information and gradient, and return errors and sigmas, as `gather` does.

    The last that is returned is an upper triangular root (run, n, n) of the covariance; the
    squares of its rows are the variances.
    """
    runs, epochs, c, d = moved.shape
    n = information.shape[1]
    error = np.empty((runs, epochs, c + n - d))
    sigma = np.empty((runs, epochs, c + n - d))
    roots, upper, lower = np.zeros((runs, n, n)), np.empty((n, n)), np.empty((n, n))
    turned, solved = np.empty((c, n)), np.empty(n)
    for run in range(runs):
        matrix, right, inverse = information[run], gradient[run], roots[run]
        for k in range(epochs):
            _add(matrix, right, rows[run, k], residual[run, k])
            cholesky(matrix, upper, lower)
            _invert(upper, inverse)
            for i in range(n):
                solved[i] = right[i]
                for j in range(i):
                    solved[i] -= lower[i, j] * solved[j]
                solved[i] *= inverse[i, i]
            found, spread = error[run, k], sigma[run, k]
            for a in range(c):
                for i in range(n):
                    turned[a, i] = 0.0
                add_products(turned, a, inverse, moved[run, k], a, 0, d, 0, 1.0)
                found[a], spread[a] = _products(turned[a], solved)
            for i in range(d, n):
                found[c + i - d], spread[c + i - d] = _products(inverse[i], solved)
        for i in range(n):
            for j in range(i):
                matrix[i, j] = matrix[j, i]
    return error, sigma, roots


@compiled
def _add(matrix: Array, right: Array, rows: Array, residual: Array) -> None:
    """Add rows (m, n) and residuals to what is on and above the diagonal, and to the gradient."""
    n = len(right)
    for q in range(len(rows)):
        for i in range(n):
            by = rows[q, i]
            if by != 0.0:
                right[i] += by * residual[q]
                for j in range(np.uint64(i), np.uint64(n)):
                    matrix[i, j] += by * rows[q, j]


@compiled
def _invert(upper: Array, inverse: Array) -> None:
    """Write the inverse of an upper triangular matrix (n, n), whose lower half is zero."""
    n = len(upper)
    for i in range(n - 1, -1, -1):
        scale = 1.0 / upper[i, i]
        for j in range(np.uint64(i), np.uint64(n)):
            inverse[i, j] = 0.0
        add_products(inverse, i, inverse, upper, i, i + 1, n, i + 1, -scale)
        inverse[i, i] = scale


@compiled
def _products(row: Array, other: Array) -> tuple[float, float]:
    """Product of two vectors, and the norm of the first; four sums let them become vectors."""
    n = len(row)
    a = b = c = d = p = q = r = s = 0.0
    for i in range(0, n - 3, 4):
        a, b = a + row[i] * other[i], b + row[i + 1] * other[i + 1]
        c, d = c + row[i + 2] * other[i + 2], d + row[i + 3] * other[i + 3]
        p, q = p + row[i] ** 2, q + row[i + 1] ** 2
        r, s = r + row[i + 2] ** 2, s + row[i + 3] ** 2
    for i in range(n - n % 4, n):
        a, p = a + row[i] * other[i], p + row[i] ** 2
    return (a + b) + (c + d), float(np.sqrt((p + q) + (r + s)))
