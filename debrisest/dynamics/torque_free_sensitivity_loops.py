"""Derivatives of torque-free rotation over its steps as plain loops, for `debrisest.compiled`.

Equations and scheme are those of `torque_free_sensitivity`, where their words are. `LANES` steps
lie side by side in arrays, each number at a place that the compiler knows.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.rotation_loops import conjugate, product
from debrisest.attitude.vector_loops import Vector, vector
from debrisest.compiled import compiled
from debrisest.dynamics.torque_free_loops import at, body_of

LANES = 32
_Y, _Z, _U, _V, _W, _P, _Q, _R = (LANES * c for c in range(1, 9))


@compiled
def ends_and_middles(times: Array, parts: int) -> Array:
    """Times since the first of the ends of the parts of all steps, then those of their middles."""
    count = parts * (len(times) - 1)
    result = np.empty(2 * count + 1)
    for i in range(count):
        t, part = i // parts, i % parts
        step = times[t + 1] - times[t]
        result[i] = times[t] - times[0] + part / parts * step
        result[count + 1 + i] = times[t] - times[0] + (part + 0.5) / parts * step
    result[count] = times[-1] - times[0]
    return result


@compiled
def motion(times: Array, q0: Array, rate0: Array, moments: Array) -> tuple[Array, Array]:
    """Attitudes (4, time) and rates (3, time) by the closed form."""
    body = body_of(rate0, moments)
    order, count = body[-1], len(times)
    ordered, about = np.empty((3, count)), np.empty((4, count))
    at(times, body, ordered, about)
    axes = np.array([0, 1 + order[0], 1 + order[1], 1 + order[2]])
    first = np.empty(4)
    first[axes] = about[:, 0] / np.sum(about[:, 0] ** 2)
    left = product(q0, conjugate(first))
    q, rate = np.zeros((4, count)), np.empty((3, count))
    for j in range(4):
        by = product(left, np.eye(4)[axes[j]])
        for i in range(4):
            for t in range(count):
                q[i, t] += by[i] * about[j, t]
    for i in range(3):
        rate[order[i]] = ordered[i]
    return q, rate


@compiled
def derivatives(
    times: Array, q: Array, rate: Array, first: int, slope: Array, by_ratios: Array, result: Array
) -> None:
    """Write those of rate and turn after some steps by rate and ratios before, (2, 5, 3) lanes.

    ``times``, ``q (4, time)``, ``rate (3, time)`` are those of ends and middles of all steps.
    """
    steps = len(times) // 2
    count = min(LANES, steps - first)
    width = 8 * ((count + 7) // 8)
    step, turn, rates = np.zeros(LANES), np.empty(27 * LANES), np.zeros(9 * LANES)
    for k in range(count):
        step[k] = times[first + k + 1] - times[first + k]
    for place in range(3):
        w = np.zeros(4 * LANES)
        begin = steps + 1 + first if place == 1 else first + place // 2
        for c in range(4):
            for k in range(count):
                w[LANES * c + k] = q[c, begin + k]
        for c in range(3):
            for k in range(count):
                rates[LANES * (3 * place + c) + k] = rate[c, begin + k]
        _axes(w, width, turn[9 * LANES * place :])
    for b in range(5):
        start, forced = (1.0 * (b == 0), 1.0 * (b == 1), 1.0 * (b == 2)), (0.0, 0.0, 0.0)
        if b > 2:
            forced = by_ratios[0, b - 3], by_ratios[1, b - 3], by_ratios[2, b - 3]
        column = result[3 * b * LANES :], result[(15 + 3 * b) * LANES :]
        _column(step, rates, turn, vector(slope), start, forced, width, *column)


@compiled
def _axes(q: Array, width: int, turn: Array) -> None:
    """Write rotation matrices (9) of quaternions (4), by columns."""
    for k in range(width):
        w, x, y, z = q[k], q[_Y + k], q[_Z + k], q[_U + k]
        turn[k], turn[_Y + k] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z)
        turn[_Z + k], turn[_U + k] = 2.0 * (x * z - w * y), 2.0 * (x * y - w * z)
        turn[_V + k], turn[_W + k] = 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)
        turn[_P + k], turn[_Q + k] = 2.0 * (x * z + w * y), 2.0 * (y * z - w * x)
        turn[_R + k] = 1.0 - 2.0 * (x * x + y * y)


@compiled
def _column(
    step: Array,
    rates: Array,
    turn: Array,
    slope: Vector,
    start: Vector,
    forced: Vector,
    width: int,
    by: Array,
    turned: Array,
) -> None:
    """Write how rate and turn (3) at the ends of steps change with one number before them."""
    for k in range(width):
        h = step[k]
        slope1 = _slope(rates, k, slope, start, forced)
        at2 = _ahead(start, 0.5 * h, slope1)
        slope2 = _slope(rates, _U + k, slope, at2, forced)
        at3 = _ahead(start, 0.5 * h, slope2)
        slope3 = _slope(rates, _U + k, slope, at3, forced)
        at4 = _ahead(start, h, slope3)
        slope4 = _slope(rates, _P + k, slope, at4, forced)
        first, last = _turned(turn, k, start), _turned(turn, 18 * LANES + k, at4)
        both = 2.0 * (at2[0] + at3[0]), 2.0 * (at2[1] + at3[1]), 2.0 * (at2[2] + at3[2])
        middle = _turned(turn, 9 * LANES + k, both)
        turned[k] = h / 6.0 * (first[0] + middle[0] + last[0])
        turned[_Y + k] = h / 6.0 * (first[1] + middle[1] + last[1])
        turned[_Z + k] = h / 6.0 * (first[2] + middle[2] + last[2])
        a = slope1[0] + 2.0 * (slope2[0] + slope3[0]) + slope4[0]
        b = slope1[1] + 2.0 * (slope2[1] + slope3[1]) + slope4[1]
        c = slope1[2] + 2.0 * (slope2[2] + slope3[2]) + slope4[2]
        by[k], by[_Y + k], by[_Z + k] = _ahead(start, h / 6.0, (a, b, c))


@compiled
def _slope(rates: Array, k: int, slope: Vector, v: Vector, forced: Vector) -> Vector:
    x, y, z = rates[k], rates[_Y + k], rates[_Z + k]
    return (
        slope[0] * (z * v[1] + y * v[2]) + y * z * forced[0],
        slope[1] * (x * v[2] + z * v[0]) + z * x * forced[1],
        slope[2] * (y * v[0] + x * v[1]) + x * y * forced[2],
    )


@compiled
def _ahead(v: Vector, step: float, slope: Vector) -> Vector:
    return v[0] + step * slope[0], v[1] + step * slope[1], v[2] + step * slope[2]


@compiled
def _turned(turn: Array, k: int, v: Vector) -> Vector:
    return (
        turn[k] * v[0] + turn[_U + k] * v[1] + turn[_P + k] * v[2],
        turn[_Y + k] * v[0] + turn[_V + k] * v[1] + turn[_Q + k] * v[2],
        turn[_Z + k] * v[0] + turn[_W + k] * v[1] + turn[_R + k] * v[2],
    )


@compiled
def chain(steps: Array, k: int, by: Array, turned: Array) -> None:
    """Carry derivatives (3, 5) over step k of those that `derivatives` wrote."""
    new = by.copy()
    for i in range(3):
        a, b, c = steps[LANES * i + k], steps[LANES * (3 + i) + k], steps[LANES * (6 + i) + k]
        o = LANES * (15 + i) + k
        u, v, w = steps[o], steps[o + _U], steps[o + _P]
        for n in range(5):
            new[i, n] = a * by[0, n] + b * by[1, n] + c * by[2, n]
            turned[i, n] += u * by[0, n] + v * by[1, n] + w * by[2, n]
        for n in range(2):
            new[i, 3 + n] += steps[LANES * (9 + 3 * n + i) + k]
            turned[i, 3 + n] += steps[LANES * (24 + 3 * n + i) + k]
    by[:] = new
