"""Quaternions and the rotation matrix of one attitude, for compiled loops."""

import math

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

Quaternion = tuple[float, float, float, float]
Vector = tuple[float, float, float]


@compiled
def matrix_of(q: Array) -> Array:
    """Rotation matrix (3, 3) of a unit quaternion (4,)."""
    return np.array(rows_of((q[0], q[1], q[2], q[3])))


@compiled
def product(p: Array, q: Array) -> Array:
    """Hamilton product of two quaternions (4,)."""
    return np.array(multiplied((p[0], p[1], p[2], p[3]), (q[0], q[1], q[2], q[3])))


@compiled
def multiplied(p: Quaternion, q: Quaternion) -> Quaternion:
    """The same of components: nothing is allocated."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


@compiled
def conjugate(q: Array) -> Array:
    """Conjugate of a quaternion (4,)."""
    return np.array([q[0], -q[1], -q[2], -q[3]])


@compiled
def rows_of(q: Quaternion) -> tuple[Vector, Vector, Vector]:
    """Rows of the rotation matrix of a unit quaternion."""
    w, x, y, z = q
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


@compiled
def inner(one: Vector, other: Vector) -> float:
    """Inner product of two vectors."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


@compiled
def conjugated(q: Quaternion) -> Quaternion:
    """Conjugate of a quaternion."""
    return q[0], -q[1], -q[2], -q[3]


@compiled
def turned_by(turn: Vector) -> Quaternion:
    """Unit quaternion of a rotation vector."""
    angle = math.sqrt(inner(turn, turn))
    half = 0.5 if angle == 0.0 else math.sin(0.5 * angle) / angle
    return math.cos(0.5 * angle), half * turn[0], half * turn[1], half * turn[2]


@compiled
def turn_of(q: Quaternion) -> Vector:
    """Shortest rotation vector of a quaternion."""
    sine = math.sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    ratio = 2.0 * math.atan2(sine, abs(q[0])) / sine if sine != 0.0 else 2.0
    ratio = -ratio if q[0] < 0.0 else ratio
    return ratio * q[1], ratio * q[2], ratio * q[3]
