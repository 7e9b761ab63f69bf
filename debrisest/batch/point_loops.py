"""Normal equations of points as plain loops over arcs and epochs, for `debrisest.compiled`."""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def normal(q: Array, turn_by: Array, product: Array, hold: Array) -> tuple[Array, Array, Array]:
    """Return sums over the epochs: of ``tr(R^T B)`` (arc,), pull (arc, 11), hold (arc, 11, 11).

    ``q (arc, time, 4)`` and ``turn_by (arc, time, 3, 11)``; ``product`` and ``hold (time, 3, 3)``
    are the first two of the sums of known points.
    """
    fits, pulls, holds = np.zeros(len(q)), np.zeros((len(q), 11)), np.zeros((len(q), 11, 11))
    r, turned, held, pull = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    by = np.empty((3, 11))
    for n in range(len(q)):
        for t in range(q.shape[1]):
            _rotation(q[n, t], r)
            _product(product[t], r, turned)
            _product(hold[t], r, held)
            fits[n] += turned[0, 0] + turned[1, 1] + turned[2, 2]
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                pull[i] = turned[k, j] - turned[j, k]
            for i in range(3):
                for j in range(3):
                    turned[i, j] = (
                        r[i, 0] * held[0, j] + r[i, 1] * held[1, j] + r[i, 2] * held[2, j]
                    )
            d = turn_by[n, t]
            for i in range(3):
                x, y, z = turned[i]
                for b in range(11):
                    by[i, b] = x * d[0, b] + y * d[1, b] + z * d[2, b]
            for a in range(11):
                pulls[n, a] += d[0, a] * pull[0] + d[1, a] * pull[1] + d[2, a] * pull[2]
                for b in range(11):
                    holds[n, a, b] += d[0, a] * by[0, b] + d[1, a] * by[1, b] + d[2, a] * by[2, b]
    return fits, pulls, holds


@compiled
def _rotation(q: Array, r: Array) -> None:
    """Write the rotation matrix of a unit quaternion."""
    w, x, y, z = q
    r[0, 0], r[0, 1] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z)
    r[0, 2], r[1, 0] = 2.0 * (x * z + w * y), 2.0 * (x * y + w * z)
    r[1, 1], r[1, 2] = 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    r[2, 0], r[2, 1] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x)
    r[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@compiled
def _product(matrix: Array, r: Array, result: Array) -> None:
    """Write the product of a matrix with the transpose of another."""
    for i in range(3):
        for j in range(3):
            result[i, j] = matrix[i, 0] * r[j, 0] + matrix[i, 1] * r[j, 1] + matrix[i, 2] * r[j, 2]
