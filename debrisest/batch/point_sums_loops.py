"""Normal equations of points of a known body as a plain loop, for `debrisest.compiled`."""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def normal(
    q: Array, turn_by: Array, product: Array, spread: Array, squares: Array
) -> tuple[float, Array, Array]:
    """Return chi-square, pull (11) and hold (11, 11) of epochs.

    Attitudes ``q (time, 4)``, derivatives ``turn_by (time, 3, 11)``, and the sums of each epoch:
    ``product`` and ``spread (time, 3, 3)`` and ``squares (time,)``.
    """
    chi2, pull, hold = 0.0, np.zeros(11), np.zeros((11, 11))
    turn, turned, held = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    vector, by = np.empty(3), np.empty((3, 11))
    for t in range(len(q)):
        w, x, y, z = q[t]
        turn[0] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
        turn[1] = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
        turn[2] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
        _by_transpose(product[t], turn, turned)
        chi2 += squares[t] - 2.0 * (turned[0, 0] + turned[1, 1] + turned[2, 2])
        vector[0] = turned[2, 1] - turned[1, 2]
        vector[1] = turned[0, 2] - turned[2, 0]
        vector[2] = turned[1, 0] - turned[0, 1]
        _by_transpose(spread[t], turn, turned)
        for i in range(3):
            for j in range(3):
                held[i, j] = (
                    turn[i, 0] * turned[0, j]
                    + turn[i, 1] * turned[1, j]
                    + turn[i, 2] * turned[2, j]
                )
        for i in range(3):
            for b in range(11):
                by[i, b] = (
                    held[i, 0] * turn_by[t, 0, b]
                    + held[i, 1] * turn_by[t, 1, b]
                    + held[i, 2] * turn_by[t, 2, b]
                )
        for a in range(11):
            for i in range(3):
                pull[a] += turn_by[t, i, a] * vector[i]
                for b in range(11):
                    hold[a, b] += turn_by[t, i, a] * by[i, b]
    return chi2, pull, hold


@compiled
def _by_transpose(a: Array, b: Array, result: Array) -> None:
    """Write ``a b^T`` (3, 3)."""
    for i in range(3):
        for j in range(3):
            result[i, j] = a[i, 0] * b[j, 0] + a[i, 1] * b[j, 1] + a[i, 2] * b[j, 2]
