"""Arcs and their derivatives as plain loops over copies and epochs, for `debrisest.compiled`."""

import math

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.rotation_loops import Quaternion, multiplied, rows_of, turned_by
from debrisest.compiled import compiled
from debrisest.dynamics.log_inertia import BASIS
from debrisest.dynamics.torque_free_loops import at, at_epoch, body_of

Arcs = tuple[Array, Array, Array]
"""Attitude (4), rate (3) and log-ratios (5) of an arc at its epoch, or of several."""
_SWEEPS = 12  # of Jacobi's rotations, of which four or five are needed


@compiled
def along(times: Array, q: Array, rate: Array, log_inertia: Array) -> tuple[Array, Array]:
    """Return ``q_if (copy, time, 4)`` and rates ``(copy, time, 3)``; times count from the epoch.

    ``q (copy, 4)``, ``rate (copy, 3)``, and ``log_inertia (copy, 3, 3)`` as matrices.
    """
    q_if, rates = np.empty((len(q), len(times), 4)), np.empty((len(q), len(times), 3))
    q_one, rate_one = np.empty((4, len(times))), np.empty((3, len(times)))
    for copy in range(len(q)):
        motion(times, q[copy], rate[copy], log_inertia[copy], q_one, rate_one)
        for t in range(len(times)):
            for i in range(4):
                q_if[copy, t, i] = q_one[i, t]
            for i in range(3):
                rates[copy, t, i] = rate_one[i, t]
    return q_if, rates


@compiled
def displaced(q: Array, rate: Array, logs: Array, error: Array) -> Arcs:
    """Return an arc moved by errors (arc, 11)."""
    count = len(error)
    q_moved, rates, ratios = np.empty((count, 4)), np.empty((count, 3)), np.empty((count, 5))
    for n in range(count):
        turn = turned_by((error[n, 0], error[n, 1], error[n, 2]))
        q_moved[n, 0], q_moved[n, 1], q_moved[n, 2], q_moved[n, 3] = multiplied(
            turn, (q[0], q[1], q[2], q[3])
        )
        for i in range(3):
            rates[n, i] = rate[i] + error[n, 3 + i]
        for i in range(5):
            ratios[n, i] = logs[i] + error[n, 6 + i]
    return q_moved, rates, ratios


@compiled
def matrix_of(logs: Array) -> Array:
    """Log-ratios (5) as a matrix (3, 3)."""
    matrix = np.zeros((3, 3))
    for n in range(5):
        for i in range(3):
            for j in range(3):
                matrix[i, j] += logs[n] * BASIS[n, i, j]
    return matrix


@compiled
def derivatives(q: Array, rate: Array, step: Array) -> tuple[Array, Array]:
    """Return those of turn and rate (arc, time, 3, 11) by differences from the first copy.

    ``q (arc, 9, time, 4)``, ``rate (arc, 9, time, 3)``, and the ``step (arc, 8)`` of the others.
    """
    arcs, times = q.shape[0], q.shape[2]
    turn_by, rate_by = np.zeros((arcs, times, 3, 11)), np.zeros((arcs, times, 3, 11))
    for n in range(arcs):
        for t in range(times):
            turn_by[n, t, 0, 0] = turn_by[n, t, 1, 1] = turn_by[n, t, 2, 2] = 1.0
            a, b, c, d = q[n, 0, t, 0], q[n, 0, t, 1], q[n, 0, t, 2], q[n, 0, t, 3]
            for k in range(8):
                w, x = q[n, k + 1, t, 0], q[n, k + 1, t, 1]
                y, z = q[n, k + 1, t, 2], q[n, k + 1, t, 3]
                per = 2.0 / (step[n, k] * (w * a + x * b + y * c + z * d))
                turn_by[n, t, 0, 3 + k] = per * (-w * b + x * a - y * d + z * c)
                turn_by[n, t, 1, 3 + k] = per * (-w * c + x * d + y * a - z * b)
                turn_by[n, t, 2, 3 + k] = per * (-w * d - x * c + y * b + z * a)
                for i in range(3):
                    ahead = rate[n, k + 1, t, i] - rate[n, 0, t, i]
                    rate_by[n, t, i, 3 + k] = ahead / step[n, k]
    return turn_by, rate_by


@compiled
def motion(times: Array, q0: Array, rate0: Array, matrix: Array, q_if: Array, rates: Array) -> None:
    """Write attitudes (4, time) and rates (3, time) of one arc."""
    moments, to_body = _principal(matrix)
    to_f = (to_body[0], -to_body[1], -to_body[2], -to_body[3])
    axes, rate_b = np.empty((3, 3)), np.zeros(3)
    for j, row in enumerate(rows_of(to_body)):
        for i in range(3):
            axes[j, i] = row[i]
            rate_b[i] += row[i] * rate0[j]
    body = body_of(rate_b, moments)
    order = body[-1]
    about = np.empty((4, len(times)))
    at(times, body, rates, about)
    a, b, c, d = at_epoch(body)
    back, by = np.zeros(4), np.empty((4, 4))
    back[0], per = a, 1.0 / (a * a + b * b + c * c + d * d)
    back[1 + order[0]], back[1 + order[1]], back[1 + order[2]] = -b, -c, -d
    left = multiplied((q0[0], q0[1], q0[2], q0[3]), to_body)
    left = multiplied(left, (per * back[0], per * back[1], per * back[2], per * back[3]))
    for k in range(4):
        i = order[k - 1] if k > 0 else -1
        unit = (1.0 * (i < 0), 1.0 * (i == 0), 1.0 * (i == 1), 1.0 * (i == 2))
        by[0, k], by[1, k], by[2, k], by[3, k] = multiplied(multiplied(left, unit), to_f)
    for i in range(4):
        a, b, c, d = by[i, 0], by[i, 1], by[i, 2], by[i, 3]
        for t in range(len(times)):
            q_if[i, t] = a * about[0, t] + b * about[1, t] + c * about[2, t] + d * about[3, t]
    for t in range(len(times)):
        a, b, c = rates[0, t], rates[1, t], rates[2, t]
        for i in range(3):
            x, y, z = axes[i, order[0]], axes[i, order[1]], axes[i, order[2]]
            rates[i, t] = x * a + y * b + z * c


@compiled
def _principal(matrix: Array) -> tuple[Array, Quaternion]:
    """Principal moments (3) and ``q_fb`` of the principal axes."""
    own, moments = matrix.copy(), np.empty(3)
    q_fb = diagonalised(own, 1e-18)
    for i in range(3):
        moments[i] = math.exp(own[i, i])
    return moments, q_fb


@compiled
def diagonalised(a: Array, least: float) -> Quaternion:
    """Turn a symmetric matrix (3, 3) into its own axes, by Jacobi's rotations, and return these.

    What is beside the diagonal is ``least`` at most.
    """
    axes = (1.0, 0.0, 0.0, 0.0)
    for _ in range(_SWEEPS):
        if not abs(a[0, 1]) + abs(a[1, 2]) + abs(a[0, 2]) > least:
            break
        for i in range(3):
            if a[i, (i + 1) % 3] != 0.0:
                cos, sin = _rotated(a, i, (i + 1) % 3)
                j = (i + 2) % 3
                turn = (cos, -sin * (j == 0), -sin * (j == 1), -sin * (j == 2))
                axes = multiplied(axes, turn)
    w, x, y, z = axes
    per = 1.0 / math.sqrt(w * w + x * x + y * y + z * z)
    return per * w, per * x, per * y, per * z


@compiled
def _rotated(a: Array, i: int, j: int) -> tuple[float, float]:
    """Turn a symmetric matrix in the plane of two axes until its element there is zero.

    Return cosine and sine of half the turn.
    """
    ratio = (a[j, j] - a[i, i]) / (2.0 * a[i, j])
    tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(ratio * ratio + 1.0))
    cos = 1.0 / math.sqrt(tangent * tangent + 1.0)
    sin = tangent * cos
    for k in range(3):
        a[k, i], a[k, j] = cos * a[k, i] - sin * a[k, j], sin * a[k, i] + cos * a[k, j]
    for k in range(3):
        a[i, k], a[j, k] = cos * a[i, k] - sin * a[j, k], sin * a[i, k] + cos * a[j, k]
    half = math.sqrt(0.5 + 0.5 * cos)
    return half, 0.5 * sin / half
