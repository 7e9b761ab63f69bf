"""Arcs and their derivatives as plain loops over copies and epochs, for `debrisest.compiled`."""

import math

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.rotation_loops import conjugate, matrix_of, product
from debrisest.compiled import compiled
from debrisest.dynamics.torque_free_loops import at, body_of

_SWEEPS = 12  # of Jacobi's rotations, of which four or five are needed


@compiled
def along(times: Array, q: Array, rate: Array, log_inertia: Array) -> tuple[Array, Array]:
    """Return ``q_if (copy, time, 4)`` and rates ``(copy, time, 3)``; times count from the epoch.

    ``q (copy, 4)``, ``rate (copy, 3)``, and ``log_inertia (copy, 3, 3)`` as matrices.
    """
    q_if, rates = np.empty((len(q), len(times), 4)), np.empty((len(q), len(times), 3))
    for copy in range(len(q)):
        _one(times, q[copy], rate[copy], log_inertia[copy], q_if[copy], rates[copy])
    return q_if, rates


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
            a, b, c, d = q[n, 0, t]
            for k in range(8):
                w, x, y, z = q[n, k + 1, t]
                per = 2.0 / (step[n, k] * (w * a + x * b + y * c + z * d))
                turn_by[n, t, 0, 3 + k] = per * (-w * b + x * a - y * d + z * c)
                turn_by[n, t, 1, 3 + k] = per * (-w * c + x * d + y * a - z * b)
                turn_by[n, t, 2, 3 + k] = per * (-w * d - x * c + y * b + z * a)
                for i in range(3):
                    ahead = rate[n, k + 1, t, i] - rate[n, 0, t, i]
                    rate_by[n, t, i, 3 + k] = ahead / step[n, k]
    return turn_by, rate_by


@compiled
def _one(times: Array, q0: Array, rate0: Array, matrix: Array, q_if: Array, rates: Array) -> None:
    """Write the motion of one arc."""
    moments, q_fb = _principal(matrix)
    axes = matrix_of(q_fb)
    body = body_of(axes.T @ rate0, moments)
    axes = axes[:, body[-1]].copy()
    rate, about = np.empty((3, 1 + len(times))), np.empty((4, 1 + len(times)))
    unit, by = np.zeros(4), np.empty((4, 4))
    at(np.zeros(1), body, rate, about)
    unit[0], unit[1 + body[-1]] = about[0, 0], about[1:, 0]
    left = product(product(q0, q_fb), conjugate(unit)) / np.sum(unit**2)
    for k in range(4):
        unit[:] = 0.0
        unit[0 if k == 0 else 1 + body[-1][k - 1]] = 1.0
        by[:, k] = product(product(left, unit), conjugate(q_fb))
    at(times, body, rate, about)
    for i in range(4):
        a, b, c, d = by[i]
        for t in range(len(times)):
            q_if[t, i] = a * about[0, t] + b * about[1, t] + c * about[2, t] + d * about[3, t]
    for i in range(3):
        a, b, c = axes[i]
        for t in range(len(times)):
            rates[t, i] = a * rate[0, t] + b * rate[1, t] + c * rate[2, t]


@compiled
def _principal(matrix: Array) -> tuple[Array, Array]:
    """Principal moments (3) and ``q_fb`` of the principal axes, by Jacobi's rotations."""
    a, q_fb = matrix.copy(), np.array([1.0, 0.0, 0.0, 0.0])
    for _ in range(_SWEEPS):
        if not np.abs(a[0, 1]) + np.abs(a[1, 2]) + np.abs(a[0, 2]) > 1e-18:
            break
        for i in range(3):
            j = (i + 1) % 3
            if a[i, j] != 0.0:
                q_fb = product(q_fb, _rotated(a, i, j))
    return np.exp(np.diag(a)), q_fb / math.sqrt(np.sum(q_fb**2))


@compiled
def _rotated(a: Array, i: int, j: int) -> Array:
    """Turn a symmetric matrix in the plane of two axes until its element there is zero."""
    ratio = (a[j, j] - a[i, i]) / (2.0 * a[i, j])
    tangent = math.copysign(1.0, ratio) / (abs(ratio) + math.sqrt(ratio * ratio + 1.0))
    cos = 1.0 / math.sqrt(tangent * tangent + 1.0)
    sin = tangent * cos
    for k in range(3):
        a[k, i], a[k, j] = cos * a[k, i] - sin * a[k, j], sin * a[k, i] + cos * a[k, j]
    for k in range(3):
        a[i, k], a[j, k] = cos * a[i, k] - sin * a[j, k], sin * a[i, k] + cos * a[j, k]
    turn = np.zeros(4)
    turn[0] = math.sqrt(0.5 + 0.5 * cos)
    turn[1 + (j + 1) % 3] = -0.5 * sin / turn[0]
    return turn
