"""Motion with what lies between the sides of a spread, as plain loops, for `debrisest.compiled`.

The steps are those of `path` and `spread`, where their words are.
"""

import math

import numpy as np

from debrisest.array_loops import fill
from debrisest.arrays import Array, IntArray
from debrisest.attitude.rotation_loops import multiplied
from debrisest.batch.arc_loops import Arcs, matrix_of, motion
from debrisest.compiled import compiled

_BLOCK = 64
_SMALL = 0.1
_ARCSINE = tuple(1.0 / (2 * n + 1) * math.comb(2 * n, n) / 4**n for n in range(10))


@compiled
def path(times: Array, arcs: Arcs, far: Array, parts: IntArray) -> tuple[Array, Array, Array]:
    """Return ``q_if (4, time)``, rates (3, time), and the joint covariance (time, 11, 11).

    Of ``arcs (arc, ...)`` the first is the motion; behind it come those of each part, all ahead,
    then all behind, ``far (arc,)`` sigmas away; ``parts (5,)`` have so many axes. Times count from
    the epoch.
    """
    count = len(times)
    q, rate, error = np.empty((4, count)), np.empty((3, count)), np.empty((6, count))
    q_side, rate_side = np.empty((4, count)), np.empty((3, count))
    motion(times, arcs[0][0], arcs[1][0], matrix_of(arcs[2][0]), q, rate)
    axes, pairs = 2 * parts[0], parts[1]
    count_of_ways = 4 * ((axes + pairs + parts[3] + 3) // 4)
    ways = np.zeros((count_of_ways, 6, count)), np.zeros((count_of_ways, 5))
    arc = 0
    for part in range(5):
        for k in range(2 * parts[part]):
            arc += 1
            ahead = k < parts[part]
            axis, weight = k if ahead else k - parts[part], 0.5 / far[arc]
            motion(times, arcs[0][arc], arcs[1][arc], matrix_of(arcs[2][arc]), q_side, rate_side)
            _turns(q, q_side, error)
            if part == 0:
                axis, weight = k, math.sqrt(0.5) / far[arc]
            elif part < 3:
                axis, weight = axes + axis, weight * (1.5 - part)
            else:
                axis, weight = (
                    axes + pairs + axis,
                    weight * (7.0 - 2.0 * part) * (1 if ahead else -1),
                )
            _add(ways[0][axis], weight, error, rate_side, rate)
            for i in range(5):
                ways[1][axis, i] += weight * (arcs[2][arc, i] - arcs[2][0, i])
    return q, rate, _joint(ways[0], ways[1])


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
def _add(way: Array, weight: float, turn: Array, rate: Array, middle: Array) -> None:
    for i in range(3):
        for t in range(way.shape[1]):
            way[i, t] += weight * turn[i, t]
        for t in range(way.shape[1]):
            way[3 + i, t] += weight * (rate[i, t] - middle[i, t])


@compiled
def _joint(ways: Array, constant: Array) -> Array:
    """Sum (time, 11, 11) of the squares of all ways, of which five numbers are constant."""
    count = ways.shape[2]
    joint, sums, same = np.empty((count, 11, 11)), np.zeros((11, 11, _BLOCK)), np.zeros((5, 5))
    for way in range(len(ways)):
        for a in range(5):
            for b in range(5):
                same[a, b] += constant[way, a] * constant[way, b]
    part = np.zeros((len(ways), 6, _BLOCK))
    for first in range(0, count, _BLOCK):
        size = min(_BLOCK, count - first)
        for way in range(len(ways)):
            for i in range(6):
                for t in range(size):
                    part[way, i, t] = ways[way, i, first + t]
        for a in range(11):
            for b in range(a + 1):
                total = sums[a, b]
                fill(same[a - 6, b - 6] if b > 5 else 0.0, total)
                for way in range(0, len(ways) if b < 6 else 0, 4):
                    if a < 6:
                        _squares(part, way, a, b, total)
                    else:
                        _shares(constant, part, way, a - 6, b, total)
        for t in range(size):
            for a in range(11):
                for b in range(a + 1):
                    joint[first + t, a, b] = joint[first + t, b, a] = sums[a, b, t]
    return joint


@compiled
def _squares(part: Array, way: int, i: int, j: int, total: Array) -> None:
    """Add the products of four ways."""
    a, b, c, d = part[way, i], part[way + 1, i], part[way + 2, i], part[way + 3, i]
    e, f, g, h = part[way, j], part[way + 1, j], part[way + 2, j], part[way + 3, j]
    for t in range(_BLOCK):
        total[t] += a[t] * e[t] + b[t] * f[t] + c[t] * g[t] + d[t] * h[t]


@compiled
def _shares(constant: Array, part: Array, way: int, i: int, j: int, total: Array) -> None:
    """The same where one does not depend on time."""
    a, b, c, d = constant[way, i], constant[way + 1, i], constant[way + 2, i], constant[way + 3, i]
    e, f, g, h = part[way, j], part[way + 1, j], part[way + 2, j], part[way + 3, j]
    for t in range(_BLOCK):
        total[t] += a * e[t] + b * f[t] + c * g[t] + d * h[t]
