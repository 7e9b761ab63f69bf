"""Rotation in orbit with its sensitivities as plain loops, for `debrisest.compiled`.

Equations and scheme are those of `tumbling_in_orbit`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

_PARTS, _WEIGHTS = (0.5, 0.5, 1.0, 0.0), (1.0, 2.0, 2.0, 1.0)


@compiled
def rotation(
    start: Array,
    inertia: Array,
    inverse: Array,
    derivative: Array,
    pace: tuple[float, float],
    duration: float,
    last: int,
    count: int,
) -> tuple[Array, Array]:
    """Return attitude and rate (run, last + 1, 7), and their errors by those of epoch 0.

    The latter are (run, last + 1, 6, 11). ``start (run, 7)``, and a body for each run; ``pace``
    is the mean motion and three times its square, zero without gravity; an epoch has ``count``
    steps of the duration, s.
    """
    moved, errors = np.empty((len(start), last + 1, 7)), np.empty((len(start), last + 1, 6, 11))
    turn, spin, radial = np.empty(4), np.empty(3), np.empty(3)
    by, at, total = np.empty((6, 11)), np.empty((6, 11)), np.empty((6, 11))
    for run in range(len(start)):
        body = (inertia[run], inverse[run], derivative[run])
        x, new, tried, now = start[run].copy(), np.empty(7), np.empty(7), np.eye(6, 11)
        for k in range(last * count + 1):
            if k % count == 0:
                moved[run, k // count], errors[run, k // count] = x, now
            if k == last * count:
                break
            new[:], tried[:] = x, x
            total[:], at[:] = now, now
            for i in range(4):
                _slopes(tried, body, pace, turn, spin, radial)
                _variation(tried[4:], radial, spin, body, pace[1], at, by)
                tried[:4] = x[:4] + _PARTS[i] * duration * turn
                tried[4:] = x[4:] + _PARTS[i] * duration * spin
                new[:4] += _WEIGHTS[i] * duration / 6.0 * turn
                new[4:] += _WEIGHTS[i] * duration / 6.0 * spin
                for a in range(6):
                    for b in range(11):
                        total[a, b] += _WEIGHTS[i] * duration / 6.0 * by[a, b]
                        at[a, b] = now[a, b] + _PARTS[i] * duration * by[a, b]
            new[:4] /= np.sqrt(np.sum(new[:4] ** 2))
            x[:], now[:] = new, total
    return moved, errors


@compiled
def _slopes(
    x: Array,
    body: tuple[Array, Array, Array],
    pace: tuple[float, float],
    turn: Array,
    spin: Array,
    radial: Array,
) -> None:
    """Write the derivatives of attitude (4) and rate (3), and the radial direction."""
    a, b, c, d, u, v, w = x
    radial[0], radial[1] = a * a + b * b - c * c - d * d, 2.0 * (b * c - a * d)
    radial[2] = 2.0 * (b * d + a * c)
    mean_motion, gravity = pace
    relative = (
        u - mean_motion * 2.0 * (b * d - a * c),
        v - mean_motion * 2.0 * (c * d + a * b),
        w - mean_motion * (a * a - b * b - c * c + d * d),
    )
    r, s, t = relative
    turn[0], turn[1] = -0.5 * (b * r + c * s + d * t), 0.5 * (a * r + c * t - d * s)
    turn[2], turn[3] = 0.5 * (a * s + d * r - b * t), 0.5 * (a * t + b * s - c * r)
    moment, pull = np.empty(3), np.empty(3)
    _applied(body[0], x[4:], moment)
    _applied(body[0], radial, pull)
    torque = np.empty(3)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        torque[i] = gravity * (radial[j] * pull[k] - radial[k] * pull[j])
        torque[i] -= x[4 + j] * moment[k] - x[4 + k] * moment[j]
    _applied(body[1], torque, spin)


@compiled
def _variation(
    w: Array,
    o: Array,
    spin: Array,
    body: tuple[Array, Array, Array],
    gravity: float,
    at: Array,
    by: Array,
) -> None:
    """Write the derivative (6, 11) of errors ``at (6, 11)``."""
    inertia, inverse, derivative = body
    torque, dw, do, ds = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    turned, moment, pull, moved = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    _applied(inertia, w, moment)
    _applied(inertia, o, pull)
    for b in range(11):
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            by[i, b] = at[3 + i, b] - w[j] * at[k, b] + w[k] * at[j, b]
            turned[i] = o[j] * at[k, b] - o[k] * at[j, b]
        _applied(inertia, at[3:, b], dw)
        _applied(inertia, turned, do)
        ds[:] = 0.0
        if b >= 6:
            _applied(derivative[b - 6], w, moved)
            dw += moved
            _applied(derivative[b - 6], o, moved)
            do += moved
            _applied(derivative[b - 6], spin, ds)
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            torque[i] = gravity * (
                turned[j] * pull[k] - turned[k] * pull[j] + o[j] * do[k] - o[k] * do[j]
            )
            torque[i] -= at[3 + j, b] * moment[k] - at[3 + k, b] * moment[j]
            torque[i] -= w[j] * dw[k] - w[k] * dw[j] + ds[i]
        _applied(inverse, torque, moved)
        by[3, b], by[4, b], by[5, b] = moved[0], moved[1], moved[2]


@compiled
def _applied(matrix: Array, vector: Array, result: Array) -> None:
    """Write the product of a matrix (3, 3) and a vector (3)."""
    for i in range(3):
        result[i] = matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2]
