"""Known points against a motion, epoch by epoch: squares, gates and sums, for `debrisest.compiled`.

Formulas are those of `point_sums`, where their words are.
"""

import numpy as np

from debrisest.array_loops import dot, fill
from debrisest.arrays import Array
from debrisest.attitude.rotation_loops import Vector, inner, rows_of
from debrisest.compiled import compiled

Points = tuple[Array, Array, Array]
"""Measured (time, feature, 3), their places in the body (feature, 3), and how even their noise is
(time, feature)."""
Sums = tuple[Array, Array, Array, Array]
"""``B`` (9, time), ``tr(F) I - F`` (6, time), its upper triangle row by row, squares and degrees of
freedom (time,)."""
_LEAST_SHARE = 0.3
_FEWEST_KEPT = 0.5
_MOST_OF_AN_EPOCH = 4


@compiled
def squares(points: Points, weight: Array, q: Array, result: Array) -> None:
    """Write the normalised squares (time, feature) at attitudes (4, time), NaN where not seen."""
    left = np.empty(points[1].shape)
    for t in range(len(weight)):
        _squared(points, weight, q, t, left, result[t])


@compiled
def gated(points: Points, weight: Array, q: Array, square: Array, limit: float) -> Array:
    """Return the weights without points that are off by more than a limit, the worst first.

    ``square (time, feature)`` are their squares. All are left if more than half would go.
    """
    left, before, after = np.empty(points[1].shape), 0, 0
    kept = weight.copy()
    for t in range(len(weight)):
        worst = _largest(square[t])
        for _ in range(_MOST_OF_AN_EPOCH):
            if not worst > limit:
                break
            for n in range(weight.shape[1]):
                if square[t, n] == worst:
                    kept[t, n] = 0.0
            _squared(points, kept, q, t, left, square[t])
            worst = _largest(square[t])
        for n in range(weight.shape[1]):
            before += weight[t, n] > 0.0
            after += kept[t, n] > 0.0
    return weight if after < _FEWEST_KEPT * before else kept


@compiled
def _largest(square: Array) -> float:
    largest = 0.0
    for value in square:
        largest = max(largest, value if value == value else 0.0)
    return largest


@compiled
def mean_residuals(points: Points, weight: Array, q: Array) -> tuple[Array, Array]:
    """Return length and variance (feature,) of the weighted residuals' sums in body axes."""
    left, total = np.empty(points[1].shape), np.zeros(points[1].shape)
    length, variance = np.zeros(len(left)), np.zeros(len(left))
    for t in range(len(weight)):
        whole, rows = residuals(points, weight, q, t, left)
        for n in range(len(left)):
            per = weight[t, n]
            for i in range(3):
                back = rows[0][i] * left[n, 0] + rows[1][i] * left[n, 1] + rows[2][i] * left[n, 2]
                total[n, i] += per * back
            variance[n] += per * (1.0 - per / max(whole, np.finfo(np.float64).tiny))
    for n in range(len(left)):
        length[n] = np.sqrt(total[n, 0] ** 2 + total[n, 1] ** 2 + total[n, 2] ** 2)
    return length, variance


@compiled
def residuals(
    points: Points, weight: Array, q: Array, t: int, left: Array
) -> tuple[float, tuple[Vector, Vector, Vector]]:
    """Write measured less expected points (feature, 3) of an epoch; return its weight and turn."""
    measured, body, per, total = points[0][t], points[1], weight[t], 0.0
    rows = rows_of((q[0, t], q[1, t], q[2, t], q[3, t]))
    x, y, z = 0.0, 0.0, 0.0
    for n in range(len(per)):
        place = body[n, 0], body[n, 1], body[n, 2]
        for i in range(3):
            left[n, i] = measured[n, i] - inner(rows[i], place)
        total += per[n]
        x += per[n] * left[n, 0]
        y += per[n] * left[n, 1]
        z += per[n] * left[n, 2]
    by = 1.0 / max(total, np.finfo(np.float64).tiny)
    for n in range(len(per)):
        left[n, 0] -= by * x
        left[n, 1] -= by * y
        left[n, 2] -= by * z
    return total, rows


@compiled
def _squared(points: Points, weight: Array, q: Array, t: int, left: Array, result: Array) -> None:
    """Write those of an epoch."""
    total, _ = residuals(points, weight, q, t, left)
    for n in range(len(result)):
        own = max(1.0 - weight[t, n] / max(total, np.finfo(np.float64).tiny), _LEAST_SHARE)
        size = left[n, 0] ** 2 + left[n, 1] ** 2 + left[n, 2] ** 2
        result[n] = size * weight[t, n] / own if weight[t, n] > 0.0 else np.nan


@compiled
def sums(points: Points, weight: Array) -> Sums:
    """Return what there is to know of points."""
    times, features = weight.shape
    product, hold = np.zeros((9, times)), np.zeros((6, times))
    squared, dof = np.zeros(times), np.empty(times)
    z, f, mean, place = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for t in range(times):
        total, count, even = 0.0, 0, 0.0
        fill(0.0, mean)
        fill(0.0, place)
        for n in range(features):
            total += weight[t, n]
            count += weight[t, n] > 0.0
            even += points[2][t, n] if weight[t, n] > 0.0 else 0.0
            for i in range(3):
                mean[i] += weight[t, n] * points[0][t, n, i]
                place[i] += weight[t, n] * points[1][n, i]
        by = 1.0 / max(total, np.finfo(np.float64).tiny)
        for n in range(features):
            per = weight[t, n]
            for i in range(3):
                z[i], f[i] = points[0][t, n, i] - by * mean[i], points[1][n, i] - by * place[i]
            for i in range(3):
                for j in range(3):
                    product[3 * i + j, t] += per * z[i] * f[j]
            a, b, c = f[0], f[1], f[2]
            hold[0, t] += per * (b * b + c * c)
            hold[1, t] -= per * a * b
            hold[2, t] -= per * a * c
            hold[3, t] += per * (a * a + c * c)
            hold[4, t] -= per * b * c
            hold[5, t] += per * (a * a + b * b)
            squared[t] += per * (dot(z, z) + a * a + b * b + c * c)
        dof[t] = 3.0 * (even - even / max(count, 1))
    return product, hold, squared, dof
