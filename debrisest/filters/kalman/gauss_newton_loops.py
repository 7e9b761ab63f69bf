"""A Gauss-Newton step of an update as plain loops, for `debrisest.compiled`.

The unknowns z of a step are those of the prior's root, x = L z, of unit covariance. With rows G of
unit noise, R^T R = I + G^T G is the inverse of what is left of it. R is that of [I, G] (QR), since
normal equations would lose what a prior knows of what is not seen.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.compiled import compiled
from debrisest.filters.kalman.root_prediction_loops import reflect
from debrisest.linear_algebra_loops import add_products

_SMALLEST_RATIO = 1e-14


@compiled
def whitened_step(
    covariance: Array, h: Array, sigma: Array, used: BoolArray, innovation: Array
) -> tuple[Array, Array, Array, Array]:
    """Return correction (run, n) and NIS (run,), and what `posterior` wants, (run, n, n) each.

    ``covariance (run, n, n)``, Jacobian ``h (run, m, n)``, noises ``sigma (m,)`` of the components,
    which are ``used (run, m)`` or not, and the innovation (run, m).
    """
    runs, m, n = h.shape
    correction, nis, z = np.zeros((runs, n)), np.zeros(runs), np.empty((1, n))
    roots, factors, lower = np.empty((runs, n, n)), np.zeros((runs, n, n)), np.zeros((n, n + 1))
    rows, left = np.empty((m, n + 1)), np.empty((n, n + 1))
    sums, shares = np.empty((1, n + 1)), np.empty((1, m))
    for run in range(runs):
        root, factor, nu = roots[run], factors[run], innovation[run]
        _root(covariance[run], root, lower)
        for q in range(m):
            rows[q] = 0.0
            if used[run, q]:
                add_products(rows, q, lower, h[run], q, 0, n, 0, 1.0 / sigma[q])
                rows[q, n] = nu[q] / sigma[q]
        for i in range(n):
            left[i] = 0.0
            left[i, i] = 1.0
        for i in range(n):
            reflect(left, rows, i, 0, sums, shares)
            for j in range(i, n):
                factor[j, i] = left[i, j]
        for k in range(n - 1, -1, -1):
            z[0, k] = left[k, n] / factor[k, k]
            for j in range(k):
                left[j, n] -= z[0, k] * factor[k, j]
        add_products(correction, run, root, z, 0, 0, n, 0, 1.0)
        for q in range(m):
            nis[run] += rows[q, n] ** 2
    return correction, nis, roots, factors


@compiled
def _root(matrix: Array, upper: Array, lower: Array) -> None:
    """Write the triangular root of a covariance, without what is known exactly."""
    n = len(matrix)
    for k in range(n):
        upper[k] = 0.0
        for j in range(np.uint64(k), np.uint64(n)):
            upper[k, j] = matrix[k, j]
        add_products(upper, k, upper, lower, k, 0, k, k, -1.0)
        exact = upper[k, k] <= _SMALLEST_RATIO * matrix[k, k]
        scale = 0.0 if exact else 1.0 / np.sqrt(upper[k, k])
        for j in range(np.uint64(k), np.uint64(n)):
            upper[k, j] *= scale
            lower[j, k] = upper[k, j]


@compiled
def posterior(roots: Array, factors: Array) -> Array:
    """Return the covariance (run, n, n) of a step, positive as a product of its root."""
    runs, n, _ = roots.shape
    covariance = np.zeros((runs, n, n))
    turned = np.empty((n, n))
    for run in range(runs):
        root, factor, spread = roots[run], factors[run], covariance[run]
        for k in range(n):
            add_products(root, k, root, factor, k, 0, k, 0, -1.0)
            scale = 1.0 / factor[k, k]
            for i in range(n):
                root[k, i] *= scale
                turned[i, k] = root[k, i]
        for i in range(n):
            add_products(spread, i, root, turned, i, 0, n, i, 1.0)
            for j in range(i, n):
                spread[j, i] = spread[i, j]
    return covariance
