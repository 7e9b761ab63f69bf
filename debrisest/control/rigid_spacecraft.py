"""A rigid spacecraft whose attitude is counted in Euler angles from turning reference axes.

Source: Li et al., Eq 4, which leaves out that the local orbital axes turn; here their rate is an
argument. Its ``R_1``, called a rotation matrix there, is the matrix of the angles' rates.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import euler


class Spacecraft(NamedTuple):
    """Inertia tensors ``(..., 3, 3)`` in body axes, kg m^2, and what follows from them."""

    inertia: Array
    inverse: Array
    gyroscopic: Array
    """(..., 9, 3): takes products of the rate's components to the free angular acceleration."""

    def acceleration(self, rate_b: Array) -> Array:
        """Angular acceleration ``-J^-1 (w x J w) (..., 3)``, rad/s^2, without a torque."""
        products = rate_b[..., :, None] * rate_b[..., None, :]
        rows = products.reshape(*rate_b.shape[:-1], 1, 9)
        return np.asarray((rows @ self.gyroscopic)[..., 0, :])

    def move(
        self, angles: Array, rate_b: Array, torque: Array, reference_rate: Array, step: float
    ) -> tuple[Array, Array]:
        """Angles and body rate ``(..., 3)`` after ``step`` seconds of a constant torque (RK4).

        ``reference_rate (..., 3)`` is that of the reference axes in these axes, rad/s. The rate is
        inertial.
        """
        pushed = turned(self.inverse, torque)
        slopes = []
        a, w = angles, rate_b
        for reach in (0.5 * step, 0.5 * step, step, 0.0):
            slope = self._angle_rates(a, w, reference_rate), pushed + self.acceleration(w)
            slopes.append(slope)
            a, w = angles + reach * slope[0], rate_b + reach * slope[1]
        (a1, w1), (a2, w2), (a3, w3), (a4, w4) = slopes
        sixth = step / 6.0
        return (
            angles + sixth * (a1 + 2.0 * (a2 + a3) + a4),
            rate_b + sixth * (w1 + 2.0 * (w2 + w3) + w4),
        )

    def _angle_rates(self, angles: Array, rate_b: Array, reference_rate: Array) -> Array:
        if reference_rate.any():
            rate_b = rate_b - reference_rate_b(angles, reference_rate)
        return euler.rates(angles, rate_b)


def spacecraft(inertia: Array) -> Spacecraft:
    """Return the spacecraft of inertia tensors ``(..., 3, 3)``, kg m^2, which must be bodies'."""
    moments = np.linalg.eigvalsh(inertia)
    if not np.array_equal(inertia, np.swapaxes(inertia, -1, -2)) or (moments <= 0.0).any():
        raise ValueError("the inertia tensor must be symmetric with positive principal moments")
    if (moments[..., 2] > moments[..., 0] + moments[..., 1]).any():
        raise ValueError("no body has this inertia tensor: a moment exceeds the sum of the others")
    inverse = np.asarray(np.linalg.inv(inertia), dtype=np.float64)
    axes = np.eye(3)
    turning = -np.cross(axes[:, None], inertia[..., None, :, :]) @ inverse[..., None, :, :]
    return Spacecraft(inertia, inverse, turning.reshape(*inertia.shape[:-2], 9, 3))


def over_time(craft: Spacecraft) -> Spacecraft:
    """Return the spacecraft ``(..., satellite)`` for arrays ``(..., time, satellite, 3)``."""
    return Spacecraft(*(matrix[..., None, :, :, :] for matrix in craft))


def scaled(inertia: Array, factors: Array) -> Array:
    """Inertia tensors of bodies whose extents along the axes have ``factors (..., 3)`` squared.

    The second moments of mass are scaled, so that any positive factors give a body.
    """
    half_trace = 0.5 * np.trace(inertia, axis1=-2, axis2=-1)[..., None, None]
    root = np.sqrt(factors)
    second = (half_trace * np.eye(3) - inertia) * (root[..., :, None] * root[..., None, :])
    return np.asarray(np.trace(second, axis1=-2, axis2=-1)[..., None, None] * np.eye(3) - second)


def reference_rate_b(angles: Array, reference_rate: Array) -> Array:
    """Rate ``(..., 3)`` of the reference axes, in body axes."""
    return np.asarray((reference_rate[..., None, :] @ euler.to_matrix(angles))[..., 0, :])


def turned(matrix: Array, vector: Array) -> Array:
    """``matrix (..., n, 3)`` times ``vector (..., 3)``."""
    return np.asarray((matrix @ vector[..., None])[..., 0])
