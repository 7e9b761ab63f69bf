"""Update by sigma points of a few errors as plain loops, for `debrisest.compiled`."""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.linear_algebra_loops import add_products, cholesky


@compiled
def corrected(
    weights: tuple[float, float],
    deviations: Array,
    response: Array,
    innovation: Array,
    noise: Array,
    noise_root: Array,
) -> tuple[Array, Array, Array]:
    """Return correction (run, n), covariance (run, n, n) and NIS (run,); spoils the deviations.

    ``weights`` are those of the central and of the other points, ``deviations (run, point, n)``,
    what is shown of them ``response (run, point, m)``, innovation (run, m), ``noise (run, m, m)``
    of the components that were observed, and a root of that of all.
    """
    runs, count, n = deviations.shape
    m = response.shape[2]
    correction, covariance, nis = np.zeros((runs, n)), np.zeros((runs, n, n)), np.zeros(runs)
    total, upper, lower = np.empty((m, m)), np.empty((m, m)), np.zeros((m, m))
    weighted, turned = np.empty((m, count)), np.empty((n, count))
    gain, spread = np.empty((m, n)), np.empty((m, n))
    for run in range(runs):
        points, shown, left = deviations[run], response[run], covariance[run]
        for q in range(m):
            for p in range(count):
                weighted[q, p] = weights[1] * shown[p, q]
            weighted[q, 0] = weights[0] * shown[0, q]
            total[q], gain[q], spread[q] = noise[run, q], 0.0, 0.0
            add_products(total, q, shown, weighted, q, 0, count, 0, 1.0)
            add_products(gain, q, points, weighted, q, 0, count, 0, 1.0)
        cholesky(total, upper, lower)
        nis[run] = _solve(upper, lower, gain, innovation, correction, run)
        for p in range(count):
            add_products(points, p, gain, shown, p, 0, m, 0, -1.0)
            for i in range(n):
                turned[i, p] = (weights[1] if p > 0 else weights[0]) * points[p, i]
        for q in range(m):
            add_products(spread, q, gain, noise_root, q, 0, m, 0, 1.0)
        for i in range(n):
            add_products(left, i, points, turned, i, 0, count, i, 1.0)
            for q in range(m):
                for j in range(i, n):
                    left[i, j] += spread[q, i] * spread[q, j]
            for j in range(i, n):
                left[j, i] = left[i, j]
    return correction, covariance, nis


@compiled
def _solve(
    upper: Array, lower: Array, gain: Array, innovation: Array, correction: Array, run: int
) -> float:
    """Turn what points and measurement share into the gain, (m, n); correct, and return NIS."""
    m, nis = len(upper), 0.0
    for q in range(m):
        add_products(gain, q, gain, lower, q, 0, q, 0, -1.0)
        for p in range(q):
            innovation[run, q] -= lower[q, p] * innovation[run, p]
        innovation[run, q] /= upper[q, q]
        nis += innovation[run, q] ** 2
        gain[q] /= upper[q, q]
    add_products(correction, run, gain, innovation, run, 0, m, 0, 1.0)
    for q in range(m - 1, -1, -1):
        add_products(gain, q, gain, upper, q, q + 1, m, 0, -1.0)
        gain[q] /= upper[q, q]
    return nis
