"""First stage: bring the target's pixel to the middle of the image and the body to rest.

Source: Li et al., Eqs 23-31. Printed Eq 23 adds the torque to a matrix that must be inverted, here
by least squares; Eqs 23 and 30 print ``lambda_0 e_1`` for ``lambda_0 de_1/dt``; the integral of Eq
28 is that of both errors. The rate of the pixel is the model's, since differences of rounded pixels
would be noise; the motion of the target itself is left out, as there.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.control.pixel_motion import curvature, rate_matrix
from debrisest.control.rigid_spacecraft import Spacecraft, turned
from debrisest.control.robust_term import Gains, Reading, Uncertainty, robust_term

NEAR = 20.0
"""Pixels from the desired one, within which the conditional integral grows."""

MIDDLE = np.zeros(2)

GAINS = Gains(
    proportional=np.array([5.0, 5.0, 1.0, 1.0, 1.0]),
    damping=np.array([3.0, 3.0]),
    robustness=np.array([0.1, 0.1, 0.001, 0.0005, 0.001]),
    boundary=np.array([60.0, 60.0, 0.3, 0.3, 0.3]),
)
"""Table 2 for two pixels and three rates; the boundary is ours."""


class Demand(NamedTuple):
    """What one stage asks for, and how its integrals grow."""

    torque: Array
    """N m, (..., 3)."""
    growth: Array
    """Of the integrals, per second, (..., n)."""


def track_pixel(
    craft: Spacecraft,
    gains: Gains,
    uncertainty: Uncertainty,
    reading: Reading,
    pixel: Array,
    rate_b: Array,
    integral: Array,
    scale: Array | float,
    desired: Array = MIDDLE,
) -> Demand:
    """Torque ``(..., 3)`` for a pixel ``(..., 2)`` and a body rate ``(..., 3)``, as measured.

    ``integral (..., 5)`` is that of the errors of pixel and rate so far, ``desired (2,)`` where the
    pixel is to be.
    """
    matrix = rate_matrix(pixel, scale)
    pixel_rate = turned(matrix, rate_b)
    free = craft.acceleration(rate_b)
    bent = curvature(pixel, pixel_rate, rate_b, scale) + turned(matrix, free)
    drift = np.concatenate([bent, free], axis=-1)
    error = np.concatenate([desired - pixel, -rate_b], axis=-1)
    feedback = gains.proportional * error - drift
    feedback[..., :2] -= gains.damping * pixel_rate
    surface = gains.proportional * integral
    surface[..., :2] += gains.damping * error[..., :2] - pixel_rate
    surface[..., 2:] += error[..., 2:]
    wanted = feedback + robust_term(reading, feedback, drift, surface, gains, uncertainty)
    if reading == "conditional":
        error = error * np.all(np.abs(error[..., :2]) < NEAR, axis=-1, keepdims=True)
    return Demand(turned(craft.inertia, _least_squares(matrix, wanted)), error)


def _least_squares(matrix: Array, wanted: Array) -> Array:
    """Angular acceleration ``(..., 3)`` nearest to what five outputs want.

    Pixels count as they are, beside rad/s^2: they outweigh the rates, which only damp the turn
    about the line of sight.
    """
    transposed = np.swapaxes(matrix, -1, -2)
    right = turned(transposed, wanted[..., :2]) + wanted[..., 2:]
    return np.asarray(np.linalg.solve(transposed @ matrix + np.eye(3), right[..., None])[..., 0])
