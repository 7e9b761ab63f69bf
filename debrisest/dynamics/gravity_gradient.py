"""Rotation of a rigid body under the gravity-gradient torque of the Earth."""

from collections.abc import Callable

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.dynamics.kepler import MU_EARTH


def tumble(
    times: Array,
    q0: Array,
    rate0: Array,
    inertia: Array,
    position: Callable[[float], Array],
    mu: float = MU_EARTH,
) -> tuple[Array, Array]:
    """Attitude ``q_ib (time, 4)`` and rate ``(time, 3)``, rad/s, of one body.

    ``times (time,)``, s, ascend from the epoch of ``q0 (4,)`` and ``rate0 (3,)``, which is zero;
    ``inertia (3, 3)`` in kg m^2, about the centre of mass; ``position(t) (3,)`` is the body's, in
    inertial axes, m. The torque is ``3 mu / r^5 r_b x (I r_b)``, the first-order term in body size
    over ``r``. Integrated by a Runge-Kutta method of order 8, relative tolerance 1e-11.
    """
    from scipy.integrate import solve_ivp

    inverse = np.linalg.inv(inertia)

    def derivative(time: float, state: Array) -> Array:
        q, rate = state[:4], state[4:]
        r_i = position(time)
        r_b = quaternion.to_matrix(quaternion.normalize(q)).T @ r_i
        gravity = 3.0 * mu / np.linalg.norm(r_i) ** 5 * matrix_of_cross(r_b) @ inertia @ r_b
        spin = 0.5 * quaternion.multiply(q, np.concatenate([[0.0], rate]))
        return np.concatenate([spin, inverse @ (gravity - matrix_of_cross(rate) @ inertia @ rate)])

    span = (0.0, max(float(times[-1]), 1.0))
    start = np.concatenate([q0, rate0])
    solution = solve_ivp(
        derivative, span, start, method="DOP853", t_eval=times, rtol=1e-11, atol=1e-13
    )
    return quaternion.normalize(solution.y[:4].T), solution.y[4:].T
