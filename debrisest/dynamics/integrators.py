"""A step of torque-free rotation in principal axes: explicit Euler, or classical Runge-Kutta.

The source is Biondi et al. (2017), Eqs 29 and 31. We depart from the printed Eq 29 in the sign of
Euler's term (``-J^-1 (w x J w)``). Components come first, which is fastest for sigma points.
"""

from collections.abc import Callable

import numpy as np

from debrisest.arrays import Array
from debrisest.dynamics.substeps import parts, substeps

Integrator = Callable[[Array, Array, Array, float], tuple[Array, Array]]


def derivative(q: Array, rate: Array, ratio: Array) -> tuple[Array, Array]:
    """Return the time derivatives of ``q_ib`` (4, ...) and of the rate (3, ...), per second.

    Components come first. ``ratio`` (3, ...) is ``(J2 - J3) / J1`` and its cyclic companions, all
    that the motion shows of the moments (Eqs 29 and 31, corrected).
    """
    slope = _slope(np.concatenate([q, rate]), ratio)
    return slope[:4], slope[4:]


def _slope(state: Array, ratio: Array) -> Array:
    """Return the time derivative (7, ...) of ``q`` and the rate, one above the other."""
    q0, q1, q2, q3, w1, w2, w3 = state
    slope = np.empty_like(state)
    q_dot, acceleration = slope[:4], slope[4:]
    q_dot[0] = -(q1 * w1 + q2 * w2 + q3 * w3)
    q_dot[1] = q0 * w1 + q2 * w3 - q3 * w2
    q_dot[2] = q0 * w2 + q3 * w1 - q1 * w3
    q_dot[3] = q0 * w3 + q1 * w2 - q2 * w1
    acceleration[0], acceleration[1], acceleration[2] = w2 * w3, w3 * w1, w1 * w2
    q_dot *= 0.5
    acceleration *= ratio
    return slope


def euler_step(q: Array, rate: Array, ratio: Array, step: float) -> tuple[Array, Array]:
    """Return ``q`` and rate after one explicit Euler step of ``step`` seconds, as printed."""
    q_dot, acceleration = derivative(q, rate, ratio)
    return q + step * q_dot, rate + step * acceleration


def rk4_step(q: Array, rate: Array, ratio: Array, step: float) -> tuple[Array, Array]:
    """Return ``q`` and rate after ``step`` seconds by classical Runge-Kutta.

    Of a fast body the step is divided (`debrisest.dynamics.substeps`).
    """
    state = np.concatenate([q, rate])
    for _, part in parts(step, substeps(np.linalg.norm(rate, axis=0), step)):
        state = _runge_kutta(state, ratio, part)
    return state[:4], state[4:]


def _runge_kutta(state: Array, ratio: Array, step: float | Array) -> Array:
    half, sixth = 0.5 * step, step / 6
    first = _slope(state, ratio)
    second = _slope(state + half * first, ratio)
    third = _slope(state + half * second, ratio)
    last = _slope(state + step * third, ratio)
    following: Array = state + sixth * (first + 2 * (second + third) + last)
    return following
