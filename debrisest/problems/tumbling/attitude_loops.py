"""Runge-Kutta steps of sigma points as plain loops, for `debrisest.compiled`.

Some points are the last axis of flat arrays ``(component x _LANES,)``, so that each loop becomes
vectors.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

_LANES = 32
_PARTS, _WEIGHTS = (0.5, 0.5, 1.0, 0.0), (1.0, 2.0, 2.0, 1.0)


@compiled
def moved(states: Array, step: float, least: float, largest: float, most: int) -> Array:
    """Return states ``(point, 14)`` after ``step`` seconds, moments kept off zero by ``least``.

    Each point's step is divided into parts of no more than the ``largest`` turn, rad, but not into
    more than ``most``, as `rk4_step` does.
    """
    result = states.copy()
    x, ratio = np.zeros(7 * _LANES), np.zeros(3 * _LANES)
    count, room = (
        np.zeros(_LANES),
        (np.empty(7 * _LANES), np.empty(7 * _LANES), np.empty(7 * _LANES)),
    )
    for first in range(0, len(states), _LANES):
        points = min(_LANES, len(states) - first)
        longest = 1.0
        for t in range(points):
            state = states[first + t]
            for i in range(4):
                x[i * _LANES + t] = state[i]
            for i in range(3):
                x[(4 + i) * _LANES + t] = state[8 + i]
                own = _off_zero(state[11 + i], least)
                after = _off_zero(state[11 + (i + 1) % 3], least)
                before = _off_zero(state[11 + (i + 2) % 3], least)
                ratio[i * _LANES + t] = (after - before) / own
            speed = np.sqrt(state[8] ** 2 + state[9] ** 2 + state[10] ** 2)
            parts = np.ceil(abs(speed * step) / largest)
            count[t] = min(parts, float(most)) if parts > 1.0 else 1.0
            longest = max(longest, count[t])
        for part in range(int(longest)):
            _runge_kutta(x, ratio, count, part, step, room)
        for t in range(points):
            for i in range(4):
                result[first + t, i] = x[i * _LANES + t]
            for i in range(3):
                result[first + t, 8 + i] = x[(4 + i) * _LANES + t]
    return result


@compiled
def _off_zero(moment: float, least: float) -> float:
    return float(np.copysign(max(abs(moment), least), moment))


@compiled
def _runge_kutta(
    x: Array,
    ratio: Array,
    count: Array,
    part: int,
    step: float,
    room: tuple[Array, Array, Array],
) -> None:
    """Move points by one of their parts; who is at the end stays there."""
    start, tried, slope = room
    for t in range(7 * _LANES):
        start[t] = tried[t] = x[t]
    for i in range(4):
        _slopes(tried, ratio, slope)
        ahead, weight = _PARTS[i], _WEIGHTS[i] / 6.0
        for c in range(7):
            for t in range(_LANES):
                length = step / count[t] if part < count[t] else 0.0
                at = c * _LANES + t
                tried[at] = start[at] + ahead * length * slope[at]
                x[at] += weight * length * slope[at]


@compiled
def _slopes(at: Array, ratio: Array, slope: Array) -> None:
    for t in range(_LANES):
        a, b, c, d = at[t], at[_LANES + t], at[2 * _LANES + t], at[3 * _LANES + t]
        u, v, w = at[4 * _LANES + t], at[5 * _LANES + t], at[6 * _LANES + t]
        slope[t] = -0.5 * (b * u + c * v + d * w)
        slope[_LANES + t] = 0.5 * (a * u + c * w - d * v)
        slope[2 * _LANES + t] = 0.5 * (a * v + d * u - b * w)
        slope[3 * _LANES + t] = 0.5 * (a * w + b * v - c * u)
        slope[4 * _LANES + t] = ratio[t] * v * w
        slope[5 * _LANES + t] = ratio[_LANES + t] * w * u
        slope[6 * _LANES + t] = ratio[2 * _LANES + t] * u * v
