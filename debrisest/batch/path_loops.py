"""Motion with what lies between the sides of a spread, as plain loops, for `debrisest.compiled`.

The steps are those of `path` and `spread`, where their words are.
"""

import math

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude.rotation_loops import multiplied
from debrisest.batch.arc_loops import Arcs, matrix_of, motion
from debrisest.compiled import compiled

_BLOCK = 64
_SMALL = 0.1
_ARCSINE = tuple(1.0 / (2 * n + 1) * math.comb(2 * n, n) / 4**n for n in range(10))


@compiled
def path(times: Array, arcs: Arcs, far: Array, parts: IntArray) -> tuple[Array, Array, Array]:
    """Return ``q_if (time, 4)``, rates (time, 3), and the joint covariance (time, 11, 11).

    Of ``arcs (arc, ...)`` the first is the motion; behind it come those of each part, all ahead,
    then all behind, ``far (arc,)`` sigmas away; ``parts (5,)`` have so many axes. Times count from
    the epoch.
    """
    count = len(times)
    q, rate, error = np.empty((4, count)), np.empty((3, count)), np.empty((6, count))
    q_side, rate_side = np.empty((4, count)), np.empty((3, count))
    motion(times, arcs[0][0], arcs[1][0], matrix_of(arcs[2][0]), q, rate)
    first_pair, first_end = 2 * parts[0], 2 * parts[0] + parts[1]
    ways = np.zeros((first_end + parts[3], 6, count)), np.zeros((first_end + parts[3], 5))
    arc = 0
    for part in range(5):
        for k in range(2 * parts[part]):
            arc += 1
            axis, sign = (k, 1.0) if k < parts[part] else (k - parts[part], -1.0)
            half = 0.5 / far[arc]
            motion(times, arcs[0][arc], arcs[1][arc], matrix_of(arcs[2][arc]), q_side, rate_side)
            _turns(q, q_side, error)
            error[3:] = rate_side - rate
            logs = arcs[2][arc] - arcs[2][0]
            if part == 0:
                _add(ways, axis, sign * half, error, logs)
                _add(ways, parts[0] + axis, half, error, logs)
            elif part < 3:
                _add(ways, first_pair + axis, half * (1.5 - part), error, logs)
            else:
                _add(ways, first_end + axis, sign * half * (7.0 - 2.0 * part), error, logs)
    return q.T.copy(), rate.T.copy(), _joint(ways[0], ways[1])


@compiled
def _turns(q: Array, other: Array, error: Array) -> None:
    """Write the rotation vectors (3, time) from one attitude to another."""
    largest = 0.0
    for t in range(q.shape[1]):
        w, x, y, z = multiplied(
            (other[0, t], other[1, t], other[2, t], other[3, t]),
            (q[0, t], -q[1, t], -q[2, t], -q[3, t]),
        )
        error[0, t], error[1, t], error[2, t], error[3, t] = x, y, z, w
        error[4, t] = x * x + y * y + z * z
        largest = max(largest, error[4, t])
    if largest < _SMALL**2:
        for t in range(q.shape[1]):
            square, ratio = error[4, t], 0.0
            for n in range(len(_ARCSINE) - 1, -1, -1):
                ratio = ratio * square + _ARCSINE[n]
            error[5, t] = 2.0 * ratio
    else:
        for t in range(q.shape[1]):
            sine = math.sqrt(error[4, t])
            turn = math.atan2(sine, abs(error[3, t]))
            error[5, t] = 2.0 * turn / sine if sine != 0.0 else 2.0
    for i in range(3):
        for t in range(q.shape[1]):
            error[i, t] *= math.copysign(error[5, t], error[3, t])


@compiled
def _add(ways: tuple[Array, Array], way: int, weight: float, error: Array, logs: Array) -> None:
    for i in range(6):
        for t in range(error.shape[1]):
            ways[0][way, i, t] += weight * error[i, t]
    for i in range(5):
        ways[1][way, i] += weight * logs[i]


@compiled
def _joint(ways: Array, constant: Array) -> Array:
    """Sum (time, 11, 11) of the squares of all ways, of which five numbers are constant."""
    count = ways.shape[2]
    joint, total = np.empty((count, 11, 11)), np.empty(_BLOCK)
    for first in range(0, count, _BLOCK):
        last = min(first + _BLOCK, count)
        for a in range(11):
            for b in range(a + 1):
                total[:] = 0.0
                for way in range(len(ways)):
                    if a < 6:
                        for t in range(first, last):
                            total[t - first] += ways[way, a, t] * ways[way, b, t]
                    elif b < 6:
                        for t in range(first, last):
                            total[t - first] += constant[way, a - 6] * ways[way, b, t]
                    else:
                        total += constant[way, a - 6] * constant[way, b - 6]
                for t in range(first, last):
                    joint[t, a, b] = joint[t, b, a] = total[t - first]
    return joint
