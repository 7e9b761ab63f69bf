"""Rotation of a rigid body under a torque that depends on time and attitude."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion

Torque = Callable[[float, Sequence[float]], Sequence[float]]
"""Torque (3) in body axes, N m, at a time, s, and a unit quaternion ``q_ib`` (4)."""
FASTEST = 200.0
"""rad/s about an axis, more than a scenario can give; what turns faster takes long to integrate."""


def driven(
    times: Array, q0: Array, rate0: Array, inertia: Array, torque: Torque
) -> tuple[Array, Array]:
    """Attitude ``q_ib (time, 4)`` and rate ``(time, 3)``, rad/s, of one body.

    ``times (time,)``, s, ascend from the epoch of ``q0 (4,)`` and ``rate0 (3,)``, which is zero;
    ``inertia (3, 3)`` in kg m^2, about the centre of mass. Integrated by a Runge-Kutta method of
    order 8, relative tolerance 1e-11. Raises ValueError where it turns faster than ``FASTEST``.
    """
    from scipy.integrate import solve_ivp

    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = inertia.tolist()
    first, second, third = np.linalg.inv(inertia).tolist()

    def derivative(time: float, state: Array) -> list[float]:
        a, b, c, d, x, y, z = state.tolist()
        if not (abs(x) <= FASTEST and abs(y) <= FASTEST and abs(z) <= FASTEST):
            raise ValueError(f"the body turns faster than {FASTEST:g} rad/s at {time:.3g} s")
        size = math.sqrt(a * a + b * b + c * c + d * d)
        e, f, g = torque(time, (a / size, b / size, c / size, d / size))
        u, v, w = xx * x + xy * y + xz * z, yx * x + yy * y + yz * z, zx * x + zy * y + zz * z
        e, f, g = e - y * w + z * v, f - z * u + x * w, g - x * v + y * u
        return [
            *(0.5 * (-b * x - c * y - d * z), 0.5 * (a * x + c * z - d * y)),
            *(0.5 * (a * y - b * z + d * x), 0.5 * (a * z + b * y - c * x)),
            *(row[0] * e + row[1] * f + row[2] * g for row in (first, second, third)),
        ]

    span = (0.0, max(float(times[-1]), 1.0))
    start = np.concatenate([q0, rate0])
    solution = solve_ivp(
        derivative, span, start, method="DOP853", t_eval=times, rtol=1e-11, atol=1e-13
    )
    return quaternion.normalize(solution.y[:4].T), solution.y[4:].T
