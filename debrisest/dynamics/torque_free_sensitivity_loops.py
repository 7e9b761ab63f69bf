"""Arcs of torque-free rotation with their derivatives as plain loops, for `debrisest.compiled`.

Equations and scheme are those of `torque_free_sensitivity`, where their words are.
"""

from typing import Any

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude.rotation_loops import conjugate, product
from debrisest.compiled import compiled
from debrisest.dynamics.torque_free_loops import at, body_of

_BY = 5


@compiled
def arcs(
    times: Array,
    start: tuple[Array, Array],
    body: tuple[Array, Array, Array],
    count: IntArray,
    result: Any,
) -> None:
    """Write a `torque_free_sensitivity.Arc` of all runs.

    ``start`` is attitude (run, 4) and rate (run, 3); a body its moments (run, 3), slopes (run, 3)
    and the derivatives (run, 3, 2) of its acceleration by the ratios over the products of rates;
    ``count (run,)`` the parts of a step.
    """
    q_ib, rate_b, turn_by, rate_by = result
    for run in range(len(count)):
        parts = count[run]
        fine = _divided(times, 2 * parts)
        q, rate = _motion(fine, start[0][run], start[1][run], body[0][run])
        for t in range(len(times)):
            q_ib[run, t], rate_b[run, t] = q[2 * parts * t], rate[2 * parts * t]
        by, turned = np.eye(3, _BY), np.zeros((3, _BY))
        for t in range(len(times)):
            turn_by[run, t], rate_by[run, t] = turned, by
            for i in range(2 * parts * t, 2 * parts * (t + 1) * (t < len(times) - 1), 2):
                step = fine[i + 2] - fine[i]
                _step(step, q[i : i + 3], rate[i : i + 3], body[1][run], body[2][run], by, turned)


@compiled
def _divided(times: Array, parts: int) -> Array:
    """Times since the first, and so many parts of each step."""
    fine = np.zeros(parts * (len(times) - 1) + 1)
    for i in range(len(fine) - 1):
        t = i // parts
        fine[i] = times[t] - times[0] + (i - parts * t) / parts * (times[t + 1] - times[t])
    fine[-1] = times[-1] - times[0]
    return fine


@compiled
def _motion(times: Array, q0: Array, rate0: Array, moments: Array) -> tuple[Array, Array]:
    """Attitudes (time, 4) and rates (time, 3) by the closed form."""
    body = body_of(rate0, moments)
    order, count = body[-1], len(times)
    ordered, about = np.empty((3, count)), np.empty((4, count))
    at(times, body, ordered, about)
    axes = np.array([0, 1 + order[0], 1 + order[1], 1 + order[2]])
    first, by = np.empty(4), np.empty((4, 4))
    first[axes] = about[:, 0] / np.sum(about[:, 0] ** 2)
    left = product(q0, conjugate(first))
    for i in range(4):
        by[:, i] = product(left, np.eye(4)[axes[i]])
    q, rate = np.zeros((count, 4)), np.empty((count, 3))
    for t in range(count):
        for i in range(4):
            for j in range(4):
                q[t, i] += by[i, j] * about[j, t]
        for i in range(3):
            rate[t, order[i]] = ordered[i, t]
    return q, rate


@compiled
def _step(
    step: float, q: Array, rate: Array, slope: Array, by_ratios: Array, by: Array, turned: Array
) -> None:
    """Carry the derivatives (3, 5) over a step, of whose ends and middle the motion is known."""
    new, at_, change = by.copy(), by.copy(), np.empty((3, _BY))
    for i in range(4):
        part = (i + 1) // 2
        _turn(q[part], at_, step / 6.0 * (1.0 if i % 3 == 0 else 2.0), turned)
        _slopes(rate[part], slope, by_ratios, at_, change)
        for a in range(3):
            for b in range(_BY):
                new[a, b] += step / 6.0 * (1.0 if i % 3 == 0 else 2.0) * change[a, b]
                at_[a, b] = by[a, b] + step * (0.5 if i < 2 else 1.0) * change[a, b]
    by[:] = new


@compiled
def _slopes(rate: Array, slope: Array, by_ratios: Array, by: Array, change: Array) -> None:
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for b in range(_BY):
            change[i, b] = slope[i] * (rate[k] * by[j, b] + rate[j] * by[k, b])
        for b in range(2):
            change[i, 3 + b] += rate[j] * rate[k] * by_ratios[i, b]


@compiled
def _turn(q: Array, by: Array, weight: float, turned: Array) -> None:
    """Add what rates turn, in inertial axes."""
    a, b, c, d = q
    per = weight / (a * a + b * b + c * c + d * d)
    for n in range(_BY):
        x, y, z = per * by[0, n], per * by[1, n], per * by[2, n]
        turned[0, n] += (a * a + b * b - c * c - d * d) * x + 2.0 * (
            (b * c - a * d) * y + (b * d + a * c) * z
        )
        turned[1, n] += (a * a - b * b + c * c - d * d) * y + 2.0 * (
            (b * c + a * d) * x + (c * d - a * b) * z
        )
        turned[2, n] += (a * a - b * b - c * c + d * d) * z + 2.0 * (
            (b * d - a * c) * x + (c * d + a * b) * y
        )
