"""Euler angles of one body, for compiled loops: the formulas are those of `euler`."""

import math

from debrisest.arrays import Array
from debrisest.compiled import compiled

Vector = tuple[float, float, float]


@compiled
def into_body(angles: Vector, vector: Array) -> Vector:
    """Return the vector (3,) of reference axes in body axes."""
    roll, tilt, yaw = angles
    s1, s2, s3 = math.sin(roll), math.sin(tilt), math.sin(yaw)
    c1, c2, c3 = math.cos(roll), math.cos(tilt), math.cos(yaw)
    x, y, z = vector[0], vector[1], vector[2]
    return (
        x * (c2 * c3) + y * (c2 * s3) - z * s2,
        x * (s1 * s2 * c3 - c1 * s3) + y * (s1 * s2 * s3 + c1 * c3) + z * (s1 * c2),
        x * (c1 * s2 * c3 + s1 * s3) + y * (c1 * s2 * s3 - s1 * c3) + z * (c1 * c2),
    )


@compiled
def rates(angles: Vector, rate_b: Vector) -> Vector:
    """Return the rates of the angles at a body rate."""
    sine, cosine = math.sin(angles[0]), math.cos(angles[0])
    yawing = (sine * rate_b[1] + cosine * rate_b[2]) / math.cos(angles[1])
    tilting = cosine * rate_b[1] - sine * rate_b[2]
    return rate_b[0] + math.sin(angles[1]) * yawing, tilting, yawing


@compiled
def body_rate(angles: Vector, angle_rates: Vector) -> Vector:
    """Return the body rate at which the angles have these rates."""
    sine, cosine = math.sin(angles[0]), math.cos(angles[0])
    rolling, tilting, yawing = angle_rates
    across = math.cos(angles[1]) * yawing
    return (
        rolling - math.sin(angles[1]) * yawing,
        cosine * tilting + sine * across,
        cosine * across - sine * tilting,
    )


@compiled
def rates_change(angles: Vector, rate_b: Vector) -> Vector:
    """Return how the rates of the angles change at a constant body rate."""
    sine, cosine = math.sin(angles[0]), math.cos(angles[0])
    tangent, near = math.tan(angles[1]), 1.0 / math.cos(angles[1])
    across = sine * rate_b[1] + cosine * rate_b[2]
    tilting = cosine * rate_b[1] - sine * rate_b[2]
    rolling = rate_b[0] + tangent * across
    return (
        rolling * tilting * tangent + across * tilting * near**2,
        -rolling * across,
        (rolling * tilting + across * tilting * tangent) * near,
    )
