"""How the pixel of a far point moves when the camera's body turns.

The motion depends on the bearing alone, so that it follows from the pixel itself: neither the
range nor the attitude enters. Source: Li et al., Eqs 24 and 26, whose derivatives with respect to
Euler angles are the same functions of the pixel.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.sensors.pinhole import BODY_TO_CAMERA


def rate_matrix(pixel: Array, scale: Array | float) -> Array:
    """Matrix ``(..., 2, 3)`` that takes the body rate, rad/s, to the pixel's rate, px/s.

    ``pixel (..., 2)`` counts from the middle, ``scale (...,)`` is the focal length in pixels.
    """
    scale = np.asarray(scale)
    x, y = pixel[..., 0] / scale, pixel[..., 1] / scale
    result = np.empty((*x.shape, 2, 3))
    result[..., 0, 0] = x * y
    result[..., 0, 1] = -(1.0 + x * x)
    result[..., 0, 2] = y
    result[..., 1, 0] = 1.0 + y * y
    result[..., 1, 1] = -x * y
    result[..., 1, 2] = -x
    return np.asarray((scale[..., None, None] * result) @ BODY_TO_CAMERA)


def curvature(pixel: Array, pixel_rate: Array, rate_b: Array, scale: Array | float) -> Array:
    """Second derivative ``(..., 2)``, px/s^2, of the pixel at a constant body rate."""
    scale = np.asarray(scale)
    x, y = pixel[..., 0] / scale, pixel[..., 1] / scale
    x_rate, y_rate = pixel_rate[..., 0], pixel_rate[..., 1]
    rate_c = rate_b @ BODY_TO_CAMERA.T
    wx, wy, wz = rate_c[..., 0], rate_c[..., 1], rate_c[..., 2]
    product = x_rate * y + x * y_rate
    result = np.empty((*np.shape(product), 2))
    result[..., 0] = product * wx - 2.0 * x * x_rate * wy + y_rate * wz
    result[..., 1] = 2.0 * y * y_rate * wx - product * wy - x_rate * wz
    return result
