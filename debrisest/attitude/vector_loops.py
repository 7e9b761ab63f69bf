"""Vectors of three floats, for compiled loops: tuples, which need no memory."""

from debrisest.arrays import Array
from debrisest.compiled import compiled

Vector = tuple[float, float, float]


@compiled
def vector(values: Array) -> Vector:
    """Return the first three of an array."""
    return values[0], values[1], values[2]


@compiled
def less(u: Vector, v: Vector) -> Vector:
    """Return ``u - v``."""
    return u[0] - v[0], u[1] - v[1], u[2] - v[2]


@compiled
def cross(u: Vector, v: Vector) -> Vector:
    """Return ``u x v``."""
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]


@compiled
def applied(matrix: Array, v: Vector) -> Vector:
    """Return a matrix (3, 3) times a vector."""
    return (
        matrix[0, 0] * v[0] + matrix[0, 1] * v[1] + matrix[0, 2] * v[2],
        matrix[1, 0] * v[0] + matrix[1, 1] * v[1] + matrix[1, 2] * v[2],
        matrix[2, 0] * v[0] + matrix[2, 1] * v[1] + matrix[2, 2] * v[2],
    )


@compiled
def applied_back(matrix: Array, v: Vector) -> Vector:
    """Return a transposed matrix (3, 3) times a vector."""
    return (
        matrix[0, 0] * v[0] + matrix[1, 0] * v[1] + matrix[2, 0] * v[2],
        matrix[0, 1] * v[0] + matrix[1, 1] * v[1] + matrix[2, 1] * v[2],
        matrix[0, 2] * v[0] + matrix[1, 2] * v[1] + matrix[2, 2] * v[2],
    )
