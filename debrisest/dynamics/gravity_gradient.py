"""Rotation of a rigid body under the gravity-gradient torque of the Earth."""

from collections.abc import Callable

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics.kepler import MU_EARTH


def tumble(
    times: Array,
    q0: Array,
    rate0: Array,
    inertia: Array,
    position: Callable[[float], Array],
    mu: float = MU_EARTH,
) -> tuple[Array, Array]:
    """Attitude ``q_ib (time, 4)`` and rate ``(time, 3)``, rad/s, of one body with full ``inertia``.

    ``times (time,)``, s, ascend from the epoch of ``q0 (4,)`` and ``rate0 (3,)``, which is zero;
    ``inertia (3, 3)`` in kg m^2; ``position(t) (3,)`` is the body's, in inertial axes, m. Integrated
    by an explicit Runge-Kutta method of order 8 to a relative tolerance of 1e-11.
    """
    from scipy.integrate import solve_ivp

    inverse = np.linalg.inv(inertia)

    def derivative(time: float, state: Array) -> Array:
        q, rate = quaternion.normalize(state[:4]), state[4:]
        r_b = quaternion.rotate(quaternion.conjugate(q), position(time))
        torque = gravity_gradient_torque(r_b, inertia, mu) - np.cross(rate, inertia @ rate)
        spin = 0.5 * quaternion.multiply(state[:4], np.concatenate([[0.0], rate]))
        return np.concatenate([spin, inverse @ torque])

    solution = solve_ivp(
        derivative,
        (0.0, times[-1]),
        np.concatenate([q0, rate0]),
        method="DOP853",
        t_eval=times,
        rtol=1e-11,
        atol=1e-13,
    )
    return quaternion.normalize(solution.y[:4].T), solution.y[4:].T


def gravity_gradient_torque(r_b: Array, inertia: Array, mu: float = MU_EARTH) -> Array:
    """Torque ``3 mu / r^5 r_b x (I r_b)``, N m, for positions ``r_b (..., 3)`` in body axes, m."""
    radius = np.linalg.norm(r_b, axis=-1, keepdims=True)
    pull = np.cross(r_b, (inertia @ r_b[..., None])[..., 0])
    return np.asarray(3.0 * mu / radius**5 * pull)
