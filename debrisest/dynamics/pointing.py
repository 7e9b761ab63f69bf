"""Attitude of a camera that looks at its target, by two turns from the Hill frame.

Camera axes ``c``: z is the optical axis, which points from the chaser at ``position_h`` to the
target at the origin. With the azimuth ``az`` and the elevation ``el`` of the chaser, the sequence
3-1-0 (Volpe et al. 2017, Eq 9) has the angles ``az + 90 deg`` and ``-(90 deg + el)``, so that x
stays in the orbit's plane; it is singular where the chaser stands above the pole, ``el = 90 deg``.
"""

import numpy as np

from debrisest.arrays import Array


def camera_axes(position_h: Array) -> Array:
    """``R_hc (..., 3, 3)`` whose columns are the camera's axes, for a chaser ``(..., 3)``, m."""
    x, y, z = np.moveaxis(position_h, -1, 0)
    level = np.hypot(x, y)
    distance = np.hypot(level, z)
    cos_az, sin_az = x / level, y / level
    cos_el, sin_el = level / distance, z / distance
    axes = [
        *(-sin_az, sin_el * cos_az, -cos_el * cos_az),
        *(cos_az, sin_el * sin_az, -cos_el * sin_az),
        *(np.zeros_like(x), -cos_el, -sin_el),
    ]
    return np.stack(axes, axis=-1).reshape(*np.shape(x), 3, 3)


def camera_rate(position_h: Array, velocity_h: Array, mean_motion: float) -> Array:
    """Rate of the camera relative to inertial axes, in its own axes ``(..., 3)``, rad/s.

    ``velocity_h (..., 3)``, m/s, is as seen in the Hill frame, which turns with ``mean_motion``,
    rad/s, about its third axis.
    """
    (x, y, z), (vx, vy, vz) = np.moveaxis(position_h, -1, 0), np.moveaxis(velocity_h, -1, 0)
    level_square = x * x + y * y
    level = np.sqrt(level_square)
    distance_square = level_square + z * z
    az_rate = (x * vy - y * vx) / level_square
    el_rate = (vz * level_square - z * (x * vx + y * vy)) / (distance_square * level)
    turning = az_rate + mean_motion
    distance = np.sqrt(distance_square)
    return np.stack([-el_rate, -turning * level / distance, -turning * z / distance], axis=-1)
