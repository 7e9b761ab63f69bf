"""Rotation of a rigid body under the gravity-gradient torque of the Earth."""

import math
from collections.abc import Callable

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics.driven_rotation import driven
from debrisest.dynamics.kepler import MU_EARTH


def tumble(
    times: Array,
    q0: Array,
    rate0: Array,
    inertia: Array,
    position: Callable[[float], Array],
    torque: Array | float = 0.0,
    mu: float = MU_EARTH,
) -> tuple[Array, Array]:
    """Attitude ``q_ib (time, 4)`` and rate ``(time, 3)``, rad/s, of one body.

    ``times``, ``q0``, ``rate0`` and ``inertia`` as of `driven`; ``position(t) (3,)`` is the body's,
    in inertial axes, m. The torque is ``3 mu / r^5 r_b x (I r_b)``, the first-order term in body
    size over ``r``, and a constant one ``torque (3,)`` in body axes, N m.
    """

    def acting(time: float, q: Array) -> Array:
        r_i = position(time)
        r_b = quaternion.to_matrix(q).T @ r_i
        (x, y, z), (a, b, c) = r_b.tolist(), (inertia @ r_b).tolist()
        crossed = np.array([y * c - z * b, z * a - x * c, x * b - y * a])
        return np.asarray(3.0 * mu / math.dist(r_i, (0.0, 0.0, 0.0)) ** 5 * crossed + torque)

    return driven(times, q0, rate0, inertia, acting)
