"""Torque-free rotation over an arc, and its derivatives by its start and by the inertia ratios.

The motion is the closed form of `debrisest.dynamics.torque_free`; the variational equations are
integrated along it by classical Runge-Kutta, all steps of the arc at once. With the body rate w,
the attitude R (body to inertial), slopes s and ratios k of `debrisest.dynamics.inertia_ratios`,

    w' = s (w2 w3, w3 w1, w1 w2),    dw' = (dw'/dw) dw + (dw'/dk) dk,    theta' = R dw,

where theta is the error of the attitude as a rotation vector in inertial axes, from the left.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.substeps import substeps
from debrisest.dynamics.torque_free import torque_free

_BY = 5
"""Columns of the derivatives: three of the rate, two of the ratios."""


class Arc(NamedTuple):
    """Attitudes and rates, and their derivatives by rate and ratios at the start."""

    q_ib: Array
    """(run, time, 4)."""
    rate_b: Array
    """(run, time, 3)."""
    turn_by_start: Array
    """Of theta, (run, time, 3, 5); the attitude at the start only adds to it."""
    rate_by_start: Array
    """Of the rate, (run, time, 3, 5)."""


def torque_free_arc(times: Array, q0: Array, rate0: Array, k: Array) -> Arc:
    """Return the arc at ``times (time,)``, s, of any order, that starts at the first of them.

    ``q0 (run, 4)``, ``rate0 (run, 3)``, rad/s, in principal axes, ``k (run, 2)``. Of a fast body
    the steps of the variational equations are divided.
    """
    count = parts_of_steps(times, rate0)
    runs, epochs = len(q0), len(times)
    result = Arc(*(np.empty((runs, epochs, *shape)) for shape in ((4,), (3,), (3, _BY), (3, _BY))))
    for parts in np.unique(count):
        chosen = np.flatnonzero(count == parts)
        found = _divided(times, q0[chosen], rate0[chosen], k[chosen], int(parts))
        for all_of, some in zip(result, found):
            all_of[chosen] = some
    return result


def parts_of_steps(times: Array, rate0: Array) -> IntArray:
    """Return in how many parts (run,) the longest step is divided, by the rate (run, 3), rad/s."""
    longest = np.abs(np.diff(times)).max(initial=0.0)
    return substeps(np.linalg.norm(rate0, axis=-1), longest)


def _divided(times: Array, q0: Array, rate0: Array, k: Array, parts: int) -> Arc:
    """Return the arc with so many ``parts`` to a step, each seen at its ends and its middle."""
    halves = 2 * parts
    index = np.arange(halves * (len(times) - 1) + 1) / halves
    fine = np.interp(index, np.arange(len(times)), times)
    q, rate = torque_free(fine - times[0], q0, rate0, inertia_ratios.moments(k))
    by_step = _variation(np.diff(fine[::2]), quaternion.to_matrix(q), rate, k[:, None])
    turn, by_rate = (values[:, ::parts] for values in _chained(*by_step))
    return Arc(q[:, ::halves], rate[:, ::halves], turn, by_rate)


def _variation(step: Array, turn: Array, rate: Array, k: Array) -> tuple[Array, Array]:
    """Changes of theta and rate over each step by rate and ratios before it, (run, step, 3, 5).

    ``turn`` and ``rate`` (run, 2 step + 1, ...) are those of the steps' ends and middles.
    """
    by_rate = inertia_ratios.acceleration_by_rate(rate, k)
    by_ratios = np.zeros((*rate.shape, _BY))
    by_ratios[..., 3:] = inertia_ratios.acceleration_by_ratios(rate, k)
    first, middle, end = slice(0, -1, 2), slice(1, None, 2), slice(2, None, 2)
    h, start = step[:, None, None], np.eye(3, _BY)
    slope1 = by_ratios[:, first].copy()
    slope1[..., :3] = by_rate[:, first]
    at2 = start + 0.5 * h * slope1
    slope2 = by_rate[:, middle] @ at2 + by_ratios[:, middle]
    at3 = start + 0.5 * h * slope2
    slope3 = by_rate[:, middle] @ at3 + by_ratios[:, middle]
    at4 = start + h * slope3
    slope4 = by_rate[:, end] @ at4 + by_ratios[:, end]
    turned = turn[:, middle] @ (2.0 * (at2 + at3)) + turn[:, end] @ at4
    turned[..., :3] += turn[:, first]
    return h / 6.0 * turned, start + h / 6.0 * (slope1 + 2.0 * (slope2 + slope3) + slope4)


def _chained(turned: Array, by_rate: Array) -> tuple[Array, Array]:
    """Derivatives (run, step + 1, 3, 5) by the start, from those of each step."""
    runs, steps = turned.shape[:2]
    rates = np.empty((runs, steps + 1, _BY, _BY))
    rates[:] = np.eye(_BY)
    for i in range(steps):
        rates[:, i + 1, :3] = by_rate[:, i] @ rates[:, i]
    turns = np.zeros((runs, steps + 1, 3, _BY))
    np.cumsum(turned @ rates[:, :-1], axis=1, out=turns[:, 1:])
    return turns, rates[:, :, :3]
