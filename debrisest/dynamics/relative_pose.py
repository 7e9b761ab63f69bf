"""Exact motion of a target's centre and attitude as seen from a leader's turning axes.

Frames: ``l`` of the leader (see `debrisest.dynamics.relative_orbit`), ``t`` of the target, its
principal axes. Two Kepler orbits and the closed form of torque-free rotation: no step size, and
nothing in common with the integration that a filter does. Under a torque the rotation is integrated
to eleven digits.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics import inertia_ratios, kepler
from debrisest.dynamics.driven_rotation import Torque, driven
from debrisest.dynamics.kepler import MU_EARTH
from debrisest.dynamics.relative_motion import drift, hill_frame
from debrisest.dynamics.relative_orbit import Leader
from debrisest.dynamics.torque_free import torque_free


def exact_translation(
    times: Array,
    position_l: Array,
    velocity_l: Array,
    leader_state: tuple[Array, Array],
    mu: float = MU_EARTH,
) -> tuple[Array, Array]:
    """Position and velocity ``(..., time, 3)`` in ``l``, m and m/s, velocity as seen in ``l``.

    They start at ``position_l (..., 3)`` and ``velocity_l``; ``leader_state`` is the leader's
    inertial position and velocity ``(3,)`` at time zero.
    """
    relative, closing = drift(*leader_state, position_l, velocity_l, times, mu)
    position, velocity = kepler.propagate(*leader_state, times, mu)
    to_l = np.swapaxes(hill_frame(position, velocity), -1, -2)
    rate = np.cross(position, velocity) / np.sum(position**2, axis=-1, keepdims=True)
    seen = closing - np.cross(rate, relative)
    return (to_l @ relative[..., None])[..., 0], (to_l @ seen[..., None])[..., 0]


def exact_rotation(
    times: Array,
    q_lt: Array,
    rate_l: Array,
    k: Array,
    leader: Leader,
    torque: Array | None = None,
) -> tuple[Array, Array]:
    """Attitude ``q_lt (..., time, 4)`` and rate ``(..., time, 3)`` relative to ``l``, in ``l``.

    ``q_lt (..., 4)`` and ``rate_l (..., 3)``, rad/s, are those at time zero, ``k (..., 2)`` the
    inertia ratios, ``leader`` the leader's orbit at ``times``, the first of which is zero
    (Pesce et al. 2017, Eqs 16-18; corrected: the leader's own inertia has no effect, and with
    the rate in ``l`` the kinematics are ``q_dot = 1/2 (0, w) q``). A constant ``torque (3,)`` acts
    about the principal axes, over the moment about each of them, rad/s^2.
    """
    spin = np.array([0.0, 0.0, 1.0]) * leader.rate[:, None]
    rate_t = quaternion.rotate(quaternion.conjugate(q_lt), rate_l + spin[0])
    moments = inertia_ratios.moments(k)
    if torque is None:
        q_it, rate_t = torque_free(times, q_lt, rate_t, moments)
    else:
        q_it, rate_t = _driven(times, q_lt, rate_t, moments, torque)
    half = 0.5 * (leader.anomaly - leader.anomaly[0])
    zero = np.zeros_like(half)
    q_li = np.stack([np.cos(half), zero, zero, -np.sin(half)], axis=-1)
    q = quaternion.multiply(q_li, q_it)
    return q, quaternion.rotate(q, rate_t) - spin


def _driven(
    times: Array, q: Array, rate: Array, moments: Array, torque: Array
) -> tuple[Array, Array]:
    """The rotation of bodies (run, ...) under a torque, in inertial axes."""
    found = [
        driven(times, q0, rate0, np.diag(mine), _constant(mine * torque))
        for q0, rate0, mine in zip(q, rate, moments)
    ]
    return np.array([each[0] for each in found]), np.array([each[1] for each in found])


def _constant(torque: Array) -> Torque:
    told: list[float] = torque.tolist()
    return lambda time, q: told
