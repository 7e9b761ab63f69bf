"""Euler angles in the order ZYX (yaw, pitch, roll)."""

import numpy as np

from debrisest.arrays import Array


def pitch(q: Array) -> Array:
    """Pitch ``asin(-R31)`` of ``R(q)``, rad, in ``[-pi/2, pi/2]``, for unit ``q (..., 4)``."""
    r31 = 2.0 * (q[..., 1] * q[..., 3] - q[..., 0] * q[..., 2])
    return np.asarray(np.arcsin(np.clip(-r31, -1.0, 1.0)))
