"""Rotation in orbit with its sensitivities as plain loops, for `debrisest.compiled`.

Equations and scheme are those of `tumbling_in_orbit`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

Vectors = tuple[Array, Array, Array]
"""Room for three vectors (3)."""
_WIDE = 16
"""Room for eleven errors that a compiler makes whole vectors of."""
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

    The latter are (run, last + 1, 6, 11), of no epoch if not wanted. ``start (run, 7)``, and a body
    for each run; ``pace`` is the mean motion and three times its square, zero without gravity; an
    epoch has ``count`` steps of the duration, s.
    """
    moved = np.empty((len(start), last + 1, 7))
    errors = np.empty((len(start), (last + 1) * sensitive, 6, 11))
    slope, radial, vectors = np.empty(7), np.empty(3), (np.empty(3), np.empty(3), np.empty(3))
    turn, spin = slope[:4], slope[4:]
    x, new, tried = np.empty(7), np.empty(7), np.empty(7)
    by_vector, by_ratios, by_motion = np.empty((3, 9)), np.empty((12, _WIDE)), np.empty((3, 6))
    ratios, beside = np.empty(_WIDE), np.zeros((3, _WIDE))
    now, at = np.empty((6, _WIDE)), np.empty((6, _WIDE))
    ahead, total = np.empty((6, _WIDE)), np.empty((6, _WIDE))
    for run in range(len(start)):
        body = (inertia[run], inverse[run], derivative[run])
        now[:] = 0.0
        for a in range(6):
            now[a, a] = 1.0
        for a in range(7):
            x[a] = start[run, a]
        _forms(body, by_vector, by_ratios)
        for k in range(last * count + 1):
            if k % count == 0:
                for a in range(7):
                    moved[run, k // count, a] = x[a]
                if sensitive:
                    _copied(now, errors[run, k // count])
            if k == last * count:
                break
            for a in range(7):
                new[a] = tried[a] = x[a]
            _copied(now, total)
            _copied(now, at)
            for i in range(4):
                slopes(tried, body, pace, turn, spin, radial, vectors)
                part, weight = _PARTS[i] * duration, _WEIGHTS[i] * duration / 6.0
                if sensitive:
                    _by_motion(by_vector, tried, radial, pace[1], by_motion)
                    _by_ratios(by_ratios, tried, radial, spin, pace[1], ratios, beside)
                    _varied(by_motion, beside, tried, at, now, part, ahead, weight, total)
                    at, ahead = ahead, at
                for a in range(7):
                    tried[a] = x[a] + part * slope[a]
                    new[a] += weight * slope[a]
            size = np.sqrt(new[0] ** 2 + new[1] ** 2 + new[2] ** 2 + new[3] ** 2)
            for a in range(7):
                x[a] = new[a] / size if a < 4 else new[a]
            now, total = total, now
    return moved, errors


@compiled
def _copied(source: Array, result: Array) -> None:
    """Write what of a wider matrix there is room for."""
    for a in range(len(result)):
        for b in range(result.shape[1]):
            result[a, b] = source[a, b]


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
def _forms(body: tuple[Array, Array, Array], by_vector: Array, by_ratios: Array) -> None:
    """Write what angular accelerations are by rates and log-ratios.

    With ``p_jk = w_j w_k - 3 n^2 o_j o_k`` that is ``-I^-1 (w x I w - 3 n^2 o x I o)``, a matrix
    (3, 9) times p: its derivative by a vector is one (3, 9) of ``(j, 3 i + k)`` times this vector.
    By the log-ratios it is (12, 15) times p and the acceleration itself, of ``5 i + b``.
    """
    inertia, inverse, derivative = body
    by_vector[:], by_ratios[:] = 0.0, 0.0
    for i in range(3):
        for m in range(3):
            j, n = (m + 1) % 3, (m + 2) % 3
            for k in range(3):
                for first, second, sign in ((j, n, -1.0), (n, j, 1.0)):
                    held = sign * inverse[i, m]
                    by_vector[k, 3 * i + first] += held * inertia[second, k]
                    by_vector[first, 3 * i + k] += held * inertia[second, k]
                    for b in range(5):
                        row = 3 * first + k
                        by_ratios[row, 5 * i + b] += held * derivative[b, second, k]
                for b in range(5):
                    by_ratios[9 + k, 5 * i + b] -= inverse[i, m] * derivative[b, m, k]


@compiled
def _by_motion(by_vector: Array, x: Array, o: Array, gravity: float, by_motion: Array) -> None:
    """Write an angular acceleration's derivative (3, 6) by attitude and rate."""
    for i in range(3):
        a = b = c = 0.0
        for k in range(3):
            by_motion[i, 3 + k] = 0.0
            for j in range(3):
                by_motion[i, 3 + k] += by_vector[j, 3 * i + k] * x[4 + j]
        for j in range(3):
            a -= gravity * by_vector[j, 3 * i] * o[j]
            b -= gravity * by_vector[j, 3 * i + 1] * o[j]
            c -= gravity * by_vector[j, 3 * i + 2] * o[j]
        by_motion[i, 0], by_motion[i, 1] = b * o[2] - c * o[1], c * o[0] - a * o[2]
        by_motion[i, 2] = a * o[1] - b * o[0]


@compiled
def _by_ratios(
    by_ratios: Array,
    x: Array,
    o: Array,
    spin: Array,
    gravity: float,
    ratios: Array,
    beside: Array,
) -> None:
    """Write its derivative (3, 5) by log-ratios, behind six zeros."""
    ratios[:] = 0.0
    for j in range(3):
        r, s = x[4 + j], gravity * o[j]
        a, b, c = r * x[4] - s * o[0], r * x[5] - s * o[1], r * x[6] - s * o[2]
        for e in range(ratios.shape[0]):
            ratios[e] += a * by_ratios[3 * j, e] + b * by_ratios[3 * j + 1, e]
        for e in range(ratios.shape[0]):
            ratios[e] += c * by_ratios[3 * j + 2, e] + spin[j] * by_ratios[9 + j, e]
    for i in range(3):
        for e in range(5):
            beside[i, 6 + e] = ratios[5 * i + e]


@compiled
def _varied(
    by_motion: Array,
    beside: Array,
    x: Array,
    at: Array,
    now: Array,
    part: float,
    ahead: Array,
    weight: float,
    total: Array,
) -> None:
    """Add the slope of errors ``at (6, .)`` to their sum, and write those of the next stage."""
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        u, v = x[4 + j], x[4 + k]
        for b in range(at.shape[1]):
            by = at[3 + i, b] - u * at[k, b] + v * at[j, b]
            total[i, b] += weight * by
            ahead[i, b] = now[i, b] + part * by
        c, d, e = by_motion[i, 0], by_motion[i, 1], by_motion[i, 2]
        f, g, h = by_motion[i, 3], by_motion[i, 4], by_motion[i, 5]
        for b in range(at.shape[1]):
            by = beside[i, b] + c * at[0, b] + d * at[1, b] + e * at[2, b]
            by += f * at[3, b] + g * at[4, b] + h * at[5, b]
            total[3 + i, b] += weight * by
            ahead[3 + i, b] = now[3 + i, b] + part * by


@compiled
def _applied(matrix: Array, vector: Array, result: Array) -> None:
    """Write the product of a matrix (3, 3) and a vector (3)."""
    for i in range(3):
        result[i] = matrix[i, 0] * vector[0] + matrix[i, 1] * vector[1] + matrix[i, 2] * vector[2]
