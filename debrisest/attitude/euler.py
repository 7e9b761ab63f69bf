"""Euler angles in the order ZYX (yaw, pitch, roll), also called 3-2-1.

Angles ``(..., 3)``, rad, are stored as ``(roll, pitch, yaw)``, in papers (phi, theta, psi). They
stand for ``R_ob = Rz(yaw) Ry(pitch) Rx(roll)``, which takes body vectors to reference axes; its
transpose is the direction cosine matrix ``C1(phi) C2(theta) C3(psi)``.
"""

import numpy as np

from debrisest.arrays import Array


def pitch(q: Array) -> Array:
    """Pitch ``asin(-R31)`` of ``R(q)``, rad, in ``[-pi/2, pi/2]``, for unit ``q (..., 4)``."""
    r31 = 2.0 * (q[..., 1] * q[..., 3] - q[..., 0] * q[..., 2])
    return np.asarray(np.arcsin(np.clip(-r31, -1.0, 1.0)))


def to_matrix(angles: Array) -> Array:
    """Rotation matrix ``R_ob (..., 3, 3)`` of Euler angles."""
    cosines, sines = np.cos(angles), np.sin(angles)
    c1, c2, c3 = cosines[..., 0], cosines[..., 1], cosines[..., 2]
    s1, s2, s3 = sines[..., 0], sines[..., 1], sines[..., 2]
    rows = (
        (c2 * c3, s1 * s2 * c3 - c1 * s3, c1 * s2 * c3 + s1 * s3),
        (c2 * s3, s1 * s2 * s3 + c1 * c3, c1 * s2 * s3 - s1 * c3),
        (-s2, s1 * c2, c1 * c2),
    )
    result = np.empty((*c1.shape, 3, 3))
    for i, row in enumerate(rows):
        for j, element in enumerate(row):
            result[..., i, j] = element
    return result


def from_matrix(matrix: Array) -> Array:
    """Euler angles ``(..., 3)`` of rotation matrices ``R_ob (..., 3, 3)``, off the poles."""
    return np.stack(
        [
            np.arctan2(matrix[..., 2, 1], matrix[..., 2, 2]),
            np.arcsin(np.clip(-matrix[..., 2, 0], -1.0, 1.0)),
            np.arctan2(matrix[..., 1, 0], matrix[..., 0, 0]),
        ],
        axis=-1,
    )


def to_quaternion(angles: Array) -> Array:
    """Unit quaternion ``q_ob (..., 4)`` of Euler angles."""
    half = 0.5 * angles
    (c1, c2, c3), (s1, s2, s3) = (np.moveaxis(f(half), -1, 0) for f in (np.cos, np.sin))
    return np.stack(
        [
            c1 * c2 * c3 + s1 * s2 * s3,
            s1 * c2 * c3 - c1 * s2 * s3,
            c1 * s2 * c3 + s1 * c2 * s3,
            c1 * c2 * s3 - s1 * s2 * c3,
        ],
        axis=-1,
    )


def rates(angles: Array, rate_b: Array) -> Array:
    """Rates ``(..., 3)``, rad/s, of the angles at a body rate ``(..., 3)`` (Li et al., Eq 4).

    Papers write ``R_1^-1 rate_b``, where ``R_1`` is not a rotation. Pole: a pitch of 90 deg.
    """
    roll, tilt = angles[..., 0], angles[..., 1]
    sine, cosine = np.sin(roll), np.cos(roll)
    across = sine * rate_b[..., 1] + cosine * rate_b[..., 2]
    yawing = across / np.cos(tilt)
    result = np.empty(np.broadcast_shapes(angles.shape, rate_b.shape))
    result[..., 0] = rate_b[..., 0] + np.sin(tilt) * yawing
    result[..., 1] = cosine * rate_b[..., 1] - sine * rate_b[..., 2]
    result[..., 2] = yawing
    return result


def body_rate(angles: Array, angle_rates: Array) -> Array:
    """Body rate ``R_1 angle_rates (..., 3)``, rad/s, the inverse of `rates`; it has no pole."""
    roll, tilt = angles[..., 0], angles[..., 1]
    sine, cosine = np.sin(roll), np.cos(roll)
    rolling, tilting, yawing = (angle_rates[..., i] for i in range(3))
    across = np.cos(tilt) * yawing
    result = np.empty(np.broadcast_shapes(angles.shape, angle_rates.shape))
    result[..., 0] = rolling - np.sin(tilt) * yawing
    result[..., 1] = cosine * tilting + sine * across
    result[..., 2] = cosine * across - sine * tilting
    return result


def rates_change(angles: Array, rate_b: Array) -> Array:
    """``(d R_1^-1 / dt) rate_b (..., 3)``, rad/s^2, while the body turns with ``rate_b``."""
    roll, tilt = angles[..., 0], angles[..., 1]
    sine, cosine = np.sin(roll), np.cos(roll)
    tangent, near = np.tan(tilt), 1.0 / np.cos(tilt)
    across = sine * rate_b[..., 1] + cosine * rate_b[..., 2]
    tilting = cosine * rate_b[..., 1] - sine * rate_b[..., 2]
    rolling = rate_b[..., 0] + tangent * across
    return np.stack(
        [
            rolling * tilting * tangent + across * tilting * near**2,
            -rolling * across,
            (rolling * tilting + across * tilting * tangent) * near,
        ],
        axis=-1,
    )
