"""Rotation of a rigid body under the gravity-gradient torque of the Earth."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from debrisest.arrays import Array
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

    first, second, third = inertia.tolist()
    more = np.broadcast_to(torque, 3).tolist()

    def acting(time: float, q: Sequence[float]) -> Sequence[float]:
        (w, x, y, z), r_i = q, position(time).tolist()
        u, v, s = r_i
        by, around = 2.0 * (x * u + y * v + z * s), 2.0 * w
        near = 2.0 * w * w - 1.0
        r = (
            near * u + by * x - around * (y * s - z * v),
            near * v + by * y - around * (z * u - x * s),
            near * s + by * z - around * (x * v - y * u),
        )
        a, b, c = (row[0] * r[0] + row[1] * r[1] + row[2] * r[2] for row in (first, second, third))
        strength = 3.0 * mu / math.hypot(*r_i) ** 5
        return (
            strength * (r[1] * c - r[2] * b) + more[0],
            strength * (r[2] * a - r[0] * c) + more[1],
            strength * (r[0] * b - r[1] * a) + more[2],
        )

    return driven(times, q0, rate0, inertia, acting)
