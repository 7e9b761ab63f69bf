"""Rotation of a rigid body relative to the Hill frame of its circular orbit, with sensitivities.

``q_hb`` takes body axes to the Hill frame ``h`` (radially outward, along track, orbit normal),
which turns at the mean motion n about its third axis; ``rate_b`` is the body's inertial rate in its
own axes; attitude errors are rotation vectors theta in body axes, ``R = R_hb exp([theta x])``. With
``o`` and ``c`` the radial and the normal direction in body axes,

    q_dot = 1/2 q (0, w - n c),    I w_dot = -w x I w + 3 n^2 o x I o,
    theta_dot = -w x theta + dw,   do = o x theta.

The equations are those of Volpe et al. 2017 with the attitude taken relative to the Hill frame, in
which rotation and translation do not depend on each other. Of the inertia only ratios matter.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.dynamics import log_inertia

TURNING = 6
"""Errors that move: attitude and rate; the five log-ratios follow them."""


class Body(NamedTuple):
    """A body's inertia up to its scale, its inverse, and its derivative by the log-ratios."""

    inertia: Array
    """(..., 3, 3)."""
    inverse: Array
    derivative: Array
    """(..., 5, 3, 3)."""


class Stages(NamedTuple):
    """Where a Runge-Kutta step evaluates the motion, (..., 4, 3): rate and radial direction."""

    rate: Array
    radial: Array


def body(log_ratios: Array) -> Body:
    """Return the body of log-ratios ``(..., 5)`` as of `debrisest.dynamics.log_inertia`."""
    return Body(*log_inertia.with_derivative(log_ratios))


def step(
    q_hb: Array,
    rate_b: Array,
    shape: Body,
    mean_motion: float,
    duration: float,
    products: Array | None = None,
    gravity: bool = True,
) -> tuple[Array, Array, Stages]:
    """Attitude and rate after one classical Runge-Kutta step, and its stages.

    ``q_hb (..., 4)``, ``rate_b (..., 3)``, rad/s, with one body each; the duration is in s. Who
    takes many steps can compute the ``products`` of `torque_products` once. Without ``gravity``
    there is no torque.
    """
    if products is None:
        products = torque_products(shape)
    rates, radials = np.empty((2, *rate_b.shape[:-1], 4, 3))
    turned, spun = np.zeros_like(q_hb), np.zeros_like(rate_b)
    q, w = q_hb, rate_b
    for i, (part, weight) in enumerate(((0.5, 1.0), (0.5, 2.0), (1.0, 2.0), (0.0, 1.0))):
        turn, spin, radial = _slopes(q, w, products, mean_motion, gravity)
        rates[..., i, :], radials[..., i, :] = w, radial
        turned += weight * turn
        spun += weight * spin
        if part:
            q, w = q_hb + (part * duration) * turn, rate_b + (part * duration) * spin
    q = q_hb + (duration / 6.0) * turned
    q /= np.sqrt((q * q).sum(-1, keepdims=True))
    return q, rate_b + (duration / 6.0) * spun, Stages(rates, radials)


def torque_products(shape: Body) -> Array:
    """Matrix ``(..., 3, 9)`` that takes the products ``w_j w_k`` to ``-I^-1 (w x I w)``."""
    columns = _CROSS @ shape.inertia[..., None, :, :]
    return np.asarray(
        shape.inverse @ np.moveaxis(columns, -3, -2).reshape(*columns.shape[:-3], 3, 9)
    )


def sensitivity(
    stages: Stages, shape: Body, mean_motion: float, duration: float, gravity: bool = True
) -> Array:
    """Derivative ``(..., 6, 11)`` of attitude and rate after a step.

    By the errors of attitude, rate and log-ratios before it, from the variational equations along
    the step's ``stages (..., 4, 3)``; ``shape`` needs the same leading axes.
    """
    by_motion, by_ratios = _variation(stages, shape, 3.0 * mean_motion**2 * gravity)
    start = np.zeros((*by_motion.shape[:-3], TURNING, 11))
    start[...] = np.eye(TURNING, 11)
    slope = np.zeros_like(start)
    slope[..., :6], slope[..., 3:, 6:] = by_motion[..., 0, :, :], by_ratios[..., 0, :, :]
    total = start + (duration / 6.0) * slope
    for i, (part, weight) in enumerate(((0.5, 2.0), (0.5, 2.0), (1.0, 1.0)), start=1):
        slope = by_motion[..., i, :, :] @ (start + (part * duration) * slope)
        slope[..., 3:, 6:] += by_ratios[..., i, :, :]
        total += (weight * duration / 6.0) * slope
    return np.asarray(total)


def _slopes(
    q: Array, w: Array, products: Array, mean_motion: float, gravity: bool
) -> tuple[Array, Array, Array]:
    """Derivatives of attitude and rate, and the radial direction in body axes."""
    squares = (q[..., :, None] * q[..., None, :]).reshape(*q.shape[:-1], 1, 16)
    directions = (squares @ _DIRECTIONS)[..., 0, :]
    radial = directions[..., :3]
    relative = w - mean_motion * directions[..., 3:]
    spinning = (relative[..., None, :] @ _SPIN).reshape(*q.shape[:-1], 4, 4)
    turn = (q[..., None, :] @ spinning)[..., 0, :]
    pull = (3.0 * mean_motion**2 * gravity) * radial
    squares = w[..., :, None] * w[..., None, :] - pull[..., :, None] * radial[..., None, :]
    spin = (products @ squares.reshape(*squares.shape[:-2], 9, 1))[..., 0]
    return turn, spin, radial


def _variation(stages: Stages, shape: Body, gravity: float) -> tuple[Array, Array]:
    """Derivatives of the slopes of errors, by errors ``(..., 4, 6, 6)`` and by log-ratios."""
    w, o = stages.rate, stages.radial
    by_products, by_vector, by_ratios = _forms(shape)
    products = w[..., :, None] * w[..., None, :] - gravity * o[..., :, None] * o[..., None, :]
    products = products.reshape(*w.shape[:-1], 9)
    spin = products @ np.swapaxes(by_products, -1, -2)
    by_motion = np.zeros((*w.shape[:-1], 6, 6))
    by_motion[..., :3, :3] = -matrix_of_cross(w)
    by_motion[..., :3, 3:] = np.eye(3)
    by_radial = (-gravity * o @ by_vector).reshape(*w.shape, 3)
    by_motion[..., 3:, :3] = by_radial @ matrix_of_cross(o)
    by_motion[..., 3:, 3:] = (w @ by_vector).reshape(*w.shape, 3)
    torques = np.concatenate([products, spin], axis=-1) @ by_ratios
    return by_motion, torques.reshape(*w.shape, 5)


def _forms(shape: Body) -> tuple[Array, Array, Array]:
    """What angular accelerations are by products p of rates and directions, and by log-ratios.

    ``-I^-1 (w x I w - 3 n^2 o x I o)`` is a matrix (..., 3, 9) times ``w_j w_k - 3 n^2 o_j o_k``;
    its derivative by a vector is this vector times one (..., 3, 9), by the log-ratios p and the
    acceleration times one (..., 12, 15).
    """
    lead = shape.inertia.shape[:-2]
    by_products = torque_products(shape)
    pairs = by_products.reshape(*lead, 3, 3, 3)
    by_vector = np.moveaxis(pairs + np.swapaxes(pairs, -1, -2), -1, -3).reshape(*lead, 3, 9)
    inverse = shape.inverse[..., None, :, :]
    of_ratios = torque_products(Body(shape.derivative, inverse, shape.derivative))
    both = np.concatenate([of_ratios, -inverse @ shape.derivative], axis=-1)
    by_ratios = np.moveaxis(both, -1, -3)
    return by_products, by_vector, np.swapaxes(by_ratios, -1, -2).reshape(*lead, 12, 15)


def _direction_products() -> Array:
    """Matrix (16, 6) that takes the products ``q_i q_j`` to ``R^T e_x`` and ``R^T e_z``."""
    terms = {  # of the rows of R(q): (i, j, sign), each symmetric pair once
        0: ((0, 0, 1), (1, 1, 1), (2, 2, -1), (3, 3, -1)),
        1: ((1, 2, 2), (0, 3, -2)),
        2: ((1, 3, 2), (0, 2, 2)),
        3: ((1, 3, 2), (0, 2, -2)),
        4: ((2, 3, 2), (0, 1, 2)),
        5: ((0, 0, 1), (1, 1, -1), (2, 2, -1), (3, 3, 1)),
    }
    result = np.zeros((16, 6))
    for column, entries in terms.items():
        for i, j, factor in entries:
            result[4 * i + j, column] = factor
    return result


def _spin_products() -> Array:
    """Matrix (3, 16) that takes a rate w to the matrix M of ``q M = 1/2 q (0, w)``."""
    result = np.zeros((3, 4, 4))
    for axis in range(3):
        a, b, c = 1 + axis, 1 + (axis + 1) % 3, 1 + (axis + 2) % 3
        result[axis, 0, a], result[axis, a, 0] = 0.5, -0.5
        result[axis, b, c], result[axis, c, b] = -0.5, 0.5
    return result.reshape(3, 16)


_DIRECTIONS, _SPIN = _direction_products(), _spin_products()
_CROSS = -matrix_of_cross(np.eye(3))
"""Matrices (3, 3, 3) of ``-e_j x``."""
