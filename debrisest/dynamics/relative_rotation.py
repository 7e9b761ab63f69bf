"""Attitude and rate of a target relative to a leader's turning axes, torque-free.

``q_lt`` takes vectors from the target's principal axes ``t`` to the leader's axes ``l``; D is its
rotation matrix; the rate is relative to ``l`` and in ``l``, rad/s. The source is Pesce et al. 2017,
Eqs 16-18, with these corrections: in Eq 17 the leader's inertia cancels out,
``w_dot = D a_t - w_l x w - w_l_dot``; and with the rate in ``l``, Eq 18 is
``q_dot = 1/2 (0, w) q``. Quaternions may have any norm: D is divided by the norm squared, unless
``raw`` asks for the polynomial as it stands. Everything takes complex numbers too.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array
from debrisest.attitude.vectors import cross, matrix_of_cross
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.relative_orbit import Leader
from debrisest.dynamics.substeps import parts, substeps


def rotate(q: NDArray[Any], v: NDArray[Any], raw: bool = False) -> NDArray[Any]:
    """``D v (..., 3)`` of a quaternion of any norm; with ``raw``, times its norm squared."""
    q0, vector = q[..., :1], q[..., 1:]
    turned = 2.0 * cross(vector, v)
    norm2 = (q * q).sum(-1, keepdims=True)
    scaled = norm2 * v + q0 * turned + cross(vector, turned)
    return np.asarray(scaled if raw else scaled / norm2)


def unrotate(q: NDArray[Any], v: NDArray[Any], raw: bool = False) -> NDArray[Any]:
    """``D^T v (..., 3)``."""
    return rotate(np.concatenate([q[..., :1], -q[..., 1:]], axis=-1), v, raw)


def rotation_derivative(
    rate: NDArray[Any], q: NDArray[Any], slope: NDArray[Any], leader: Leader, raw: bool = False
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Time derivatives of rate ``(..., 3)`` and ``q_lt (..., 4)`` (Eqs 16-18, corrected).

    ``slope (..., 3)`` as of `inertia_ratios.slopes`, which are constant and dear to compute.
    """
    spin, spin_up = leader.rate, leader.acceleration
    total = rate.copy()
    total[..., 2] += spin
    rate_t = unrotate(q, total, raw)
    acceleration = rotate(q, slope * inertia_ratios.rate_products(rate_t), raw)
    acceleration[..., 0] += spin * rate[..., 1]
    acceleration[..., 1] -= spin * rate[..., 0]
    acceleration[..., 2] -= spin_up
    scalar = -(rate * q[..., 1:]).sum(-1, keepdims=True)
    vector = q[..., :1] * rate + cross(rate, q[..., 1:])
    return acceleration, 0.5 * np.concatenate([scalar, vector], axis=-1)


def rotation_step(
    rate: NDArray[Any],
    q: NDArray[Any],
    slope: NDArray[Any],
    leader: tuple[Leader, Leader, Leader],
    step: float,
    raw: bool = False,
) -> tuple[NDArray[Any], NDArray[Any]]:
    """Rate and ``q_lt`` after a step, which may go back in time, by classical Runge-Kutta.

    ``leader`` is the orbit at the start, the middle and the end of the step; of a fast target the
    step is divided (`debrisest.dynamics.substeps`), and the orbit between is interpolated.
    """
    count = substeps(np.linalg.norm(rate.real, axis=-1) + abs(leader[0].rate), step)
    for i, part in parts(step, count):
        at = leader if part is step else _interpolated(leader, i / count, 0.5 / count)
        rate, q = _runge_kutta(rate, q, slope, at, part, raw)
    return rate, q


def _runge_kutta(
    rate: NDArray[Any],
    q: NDArray[Any],
    slope: NDArray[Any],
    leader: tuple[Leader, Leader, Leader],
    step: float | Array,
    raw: bool,
) -> tuple[NDArray[Any], NDArray[Any]]:
    start, middle, end = leader
    full = np.asarray(step)[..., None]
    half, sixth = 0.5 * full, full / 6.0
    w1, q1 = rotation_derivative(rate, q, slope, start, raw)
    w2, q2 = rotation_derivative(rate + half * w1, q + half * q1, slope, middle, raw)
    w3, q3 = rotation_derivative(rate + half * w2, q + half * q2, slope, middle, raw)
    w4, q4 = rotation_derivative(rate + full * w3, q + full * q3, slope, end, raw)
    return rate + sixth * (w1 + 2.0 * (w2 + w3) + w4), q + sixth * (q1 + 2.0 * (q2 + q3) + q4)


def _interpolated(
    leader: tuple[Leader, Leader, Leader], share: Array, half: Array
) -> tuple[Leader, Leader, Leader]:
    """Orbit at these shares of the whole step, half a substep and a substep later, by a parabola.

    Exact at the start, the middle and the end; the orbit hardly bends within a step.
    """
    moments = []
    for at in (share, share + half, share + 2.0 * half):
        u, v, w = (1.0 - 2.0 * at) * (1.0 - at), 4.0 * at * (1.0 - at), at * (2.0 * at - 1.0)
        moments.append(Leader(*(u * a + v * b + w * c for a, b, c in zip(*leader))))
    return moments[0], moments[1], moments[2]


def rotation_by_quaternion(q: Array, v: Array, raw: bool = False) -> Array:
    """Derivative ``(..., 3, 4)`` of ``D v`` with respect to the quaternion."""
    q = np.broadcast_to(q, (*v.shape[:-1], 4))
    q0, vector = q[..., :1], q[..., 1:]
    by_scalar = 2.0 * (q0 * v + cross(vector, v))
    along = (vector * v).sum(-1)[..., None, None]
    outer = vector[..., :, None] * v[..., None, :]
    by_vector = 2.0 * (
        outer - np.swapaxes(outer, -1, -2) + along * np.eye(3) - q0[..., None] * matrix_of_cross(v)
    )
    by_q = np.concatenate([by_scalar[..., None], by_vector], axis=-1)
    if raw:
        return by_q
    norm2 = (q * q).sum(-1)[..., None, None]
    return np.asarray((by_q - 2.0 * rotate(q, v)[..., None] * q[..., None, :]) / norm2)


def rotation_matrix(q: Array, raw: bool = False) -> Array:
    """``D (..., 3, 3)`` of a quaternion of any norm; with ``raw``, times its norm squared."""
    return np.swapaxes(rotate(q[..., None, :], np.eye(3), raw), -1, -2)
