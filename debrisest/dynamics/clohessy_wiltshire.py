"""Relative motion about a target on a circular orbit, linearised, in closed form.

Hill frame ``h``: origin in the target, axes radially outward, along track and along the orbit
normal; velocities are as seen in this turning frame. The equations (Clohessy and Wiltshire) are
``x'' = 3 n^2 x + 2 n y'``, ``y'' = -2 n x'``, ``z'' = -n^2 z`` with the mean motion ``n``, rad/s.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.dynamics.kepler import MU_EARTH, shape_and_anomaly

_CIRCLE = 1e-3
"""Largest eccentricity of an orbit that counts as a circle."""


def mean_motion_of(position: Array, velocity: Array, mu: float = MU_EARTH) -> float:
    """Mean motion, rad/s, of the circular orbit with an inertial state ``(3,)``, m and m/s."""
    axis, eccentricity, _ = shape_and_anomaly(position, velocity, mu)
    if eccentricity > _CIRCLE:
        raise ValueError(
            f"the target's orbit has an eccentricity of {eccentricity:.3g}; this relative motion "
            f"is for circular orbits (at most {_CIRCLE:g})"
        )
    return float(np.sqrt(mu / axis**3))


def transition(mean_motion: float, elapsed: Array | float) -> Array:
    """Matrix ``(..., 6, 6)`` that takes position and velocity over ``elapsed (...)`` seconds."""
    n, t = mean_motion, np.asarray(elapsed, dtype=np.float64)
    c, s = np.cos(n * t), np.sin(n * t)
    result = np.zeros((*t.shape, 6, 6))
    result[..., 0, 0] = 4.0 - 3.0 * c
    result[..., 0, 3] = s / n
    result[..., 0, 4] = 2.0 * (1.0 - c) / n
    result[..., 1, 0] = 6.0 * (s - n * t)
    result[..., 1, 1] = 1.0
    result[..., 1, 3] = -2.0 * (1.0 - c) / n
    result[..., 1, 4] = (4.0 * s - 3.0 * n * t) / n
    result[..., 2, 2] = c
    result[..., 2, 5] = s / n
    result[..., 3, 0] = 3.0 * n * s
    result[..., 3, 3] = c
    result[..., 3, 4] = 2.0 * s
    result[..., 4, 0] = -6.0 * n * (1.0 - c)
    result[..., 4, 3] = -2.0 * s
    result[..., 4, 4] = 4.0 * c - 3.0
    result[..., 5, 2] = -n * s
    result[..., 5, 5] = c
    return result


def propagate(
    position: Array, velocity: Array, mean_motion: float, times: Array
) -> tuple[Array, Array]:
    """Position and velocity ``(..., time, 3)`` at ``times (time,)``, s after those given.

    ``position`` and ``velocity`` are ``(..., 3)``, m and m/s.
    """
    start = np.concatenate([position, velocity], axis=-1)[..., None, :, None]
    states = (transition(mean_motion, times) @ start)[..., 0]
    return states[..., :3], states[..., 3:]


def closing_velocity(position: Array, mean_motion: float) -> Array:
    """Along-track velocity ``(...)``, m/s, for which the motion is a closed ellipse: ``-2 n x``."""
    return np.asarray(-2.0 * mean_motion * position[..., 0])
