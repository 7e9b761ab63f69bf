"""Rotation in orbit with its sensitivities as plain loops, for `debrisest.compiled`.

Equations and scheme are those of `tumbling_in_orbit`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

Vectors = tuple[Array, Array, Array]
"""Room for three vectors (3)."""
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
    sensitive: bool,
) -> tuple[Array, Array]:
    """Return attitude and rate (run, last + 1, 7), and their errors by those of epoch 0.

    The latter are (run, last + 1, 6, 11). ``start (run, 7)``, and a body for each run; ``pace``
    is the mean motion and three times its square, zero without gravity; an epoch has ``count``
    steps of the duration, s.
    """
    moved, errors = (
        np.empty((len(start), last + 1, 7)),
        np.empty((len(start), (last + 1) * sensitive, 6, 11)),
    )
    slope, radial = np.empty(7), np.empty(3)
    turn, spin = slope[:4], slope[4:]
    by, at, total = np.empty((6, 11)), np.empty((6, 11)), np.empty((6, 11))
    vectors = np.empty(3), np.empty(3), np.empty(3)
    room = (np.empty((3, 11)), np.empty((3, 11)), np.empty((3, 3)))
    for run in range(len(start)):
        body = (inertia[run], inverse[run], derivative[run])
        x, new, tried, now = start[run].copy(), np.empty(7), np.empty(7), np.eye(6, 11)
        for k in range(last * count + 1):
            if k % count == 0:
                moved[run, k // count] = x
                if sensitive:
                    errors[run, k // count] = now
            if k == last * count:
                break
            new[:], tried[:] = x, x
            total[:], at[:] = now, now
            for i in range(4):
                slopes(tried, body, pace, turn, spin, radial, vectors)
                if sensitive:
                    _variation(tried[4:], radial, spin, body, pace[1], at, by, vectors, room)
                part, weight = _PARTS[i] * duration, _WEIGHTS[i] * duration / 6.0
                for a in range(7):
                    tried[a] = x[a] + part * slope[a]
                    new[a] += weight * slope[a]
                for a in range(6 * sensitive):
                    for b in range(11):
                        total[a, b] += weight * by[a, b]
                        at[a, b] = now[a, b] + part * by[a, b]
            new[:4] /= np.sqrt(np.sum(new[:4] ** 2))
            x[:], now[:] = new, total
    return moved, errors


@compiled
def slopes(
    x: Array,
    body: tuple[Array, Array, Array],
    pace: tuple[float, float],
    turn: Array,
    spin: Array,
    radial: Array,
    vectors: Vectors,
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
    moment, pull, torque = vectors
    _applied(body[0], x[4:], moment)
    _applied(body[0], radial, pull)
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
    vectors: Vectors,
    room: tuple[Array, Array, Array],
) -> None:
    """Write the derivative (6, 11) of errors ``at (6, 11)``."""
    torque, slope, by_radial = room
    _torques(w, o, spin, body, gravity, torque, by_radial, vectors)
    inverse = body[1]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for b in range(11):
            slope[i, b] = inverse[i, 0] * torque[0, b] + inverse[i, 1] * torque[1, b]
            slope[i, b] += inverse[i, 2] * torque[2, b]
        for b in range(11):
            by[i, b] = at[3 + i, b] - w[j] * at[k, b] + w[k] * at[j, b]
            by[3 + i, b] = slope[i, b] if b >= 6 else 0.0
        for c in range(6):
            for b in range(11):
                by[3 + i, b] += slope[i, c] * at[c, b]


@compiled
def _torques(
    w: Array,
    o: Array,
    spin: Array,
    body: tuple[Array, Array, Array],
    gravity: float,
    torque: Array,
    by_radial: Array,
    vectors: Vectors,
) -> None:
    """Write the derivative (3, 11) of the torque, with the inertial one, by errors."""
    inertia, _, derivative = body
    moment, pull, held = vectors
    _applied(inertia, w, moment)
    _applied(inertia, o, pull)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for c in range(3):
            by_radial[i, c] = gravity * (o[j] * inertia[k, c] - o[k] * inertia[j, c])
            torque[i, 3 + c] = w[k] * inertia[j, c] - w[j] * inertia[k, c]
        by_radial[i, j] += gravity * pull[k]
        by_radial[i, k] -= gravity * pull[j]
        torque[i, 3 + j] -= moment[k]
        torque[i, 3 + k] += moment[j]
    for c in range(3):
        d, e = (c + 1) % 3, (c + 2) % 3
        for i in range(3):
            torque[i, c] = by_radial[i, d] * o[e] - by_radial[i, e] * o[d]
    for b in range(5):
        _applied(derivative[b], w, moment)
        _applied(derivative[b], o, pull)
        _applied(derivative[b], spin, held)
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            pulled = gravity * (o[j] * pull[k] - o[k] * pull[j])
            torque[i, 6 + b] = pulled - (w[j] * moment[k] - w[k] * moment[j]) - held[i]


@compiled
def _applied(matrix: Array, vector: Array, result: Array) -> None:
    """Write the product of a matrix (3, 3) and a vector (3)."""
    for i in range(3):
        result[i] = matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2]
