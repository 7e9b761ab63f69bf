"""Unit quaternions on arrays of shape ``(..., 4)``.

Conventions: Hamilton product, scalar part first. ``q_ib`` takes body vectors to inertial ones,
``v_i = R(q_ib) v_b``, so that rotations compose as ``q_ic = multiply(q_ib, q_bc)``; with the rate
``w_b`` in body axes, ``q_dot = 1/2 q * (0, w_b)``. ``q`` and ``-q`` are the same rotation. Rotation
vectors are in radians. Leading axes broadcast, and NaN in gives NaN out.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.vectors import cross

NEWTON_STEPS = 30  # of which six are taken, and more only where two rotations are about as near
ABOVE = 1e-9  # of the norm of a matrix, by which its eigenvalue is missed: nothing is singular


def multiply(p: Array, q: Array) -> Array:
    """Hamilton product ``p q``, ``(..., 4)``: the rotation ``q`` followed by ``p``."""
    p0, p1, p2, p3 = _components(p)
    q0, q1, q2, q3 = _components(q)
    scalar = p0 * q0 - p1 * q1 - p2 * q2 - p3 * q3
    result = np.empty((*np.shape(scalar), 4))
    result[..., 0] = scalar
    result[..., 1] = p0 * q1 + p1 * q0 + p2 * q3 - p3 * q2
    result[..., 2] = p0 * q2 - p1 * q3 + p2 * q0 + p3 * q1
    result[..., 3] = p0 * q3 + p1 * q2 - p2 * q1 + p3 * q0
    return result


def conjugate(q: Array) -> Array:
    """Conjugate, which for a unit quaternion is the inverse rotation."""
    return np.asarray(q * np.array([1.0, -1.0, -1.0, -1.0]))


def normalize(q: Array) -> Array:
    """``q`` scaled to unit norm; a zero quaternion, which is no rotation, gives NaN."""
    with np.errstate(invalid="ignore"):
        return np.asarray(q / _length(q))


def rotate(q: Array, v: Array) -> Array:
    """``R(q) v`` for vectors ``v (..., 3)``."""
    vector = q[..., 1:]
    twice_cross = 2.0 * cross(vector, v)
    return np.asarray(v + q[..., :1] * twice_cross + cross(vector, twice_cross))


def to_matrix(q: Array) -> Array:
    """Rotation matrix ``R(q) (..., 3, 3)`` of a unit quaternion."""
    w, x, y, z = _components(q)
    elements = [
        *(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        *(2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        *(2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    ]
    return _gathered(elements).reshape(*np.shape(w), 3, 3)


def from_matrix(matrix: Array) -> Array:
    """Unit quaternion ``(..., 4)``, scalar part not negative, of rotation matrices ``(..., 3, 3)``.

    The elements give all products ``4 q_i q_j``; the row of the largest component is used, so that
    no trace is singular.
    """
    return _positive(_largest_row(_products(matrix)))


def nearest(matrix: Array) -> Array:
    """Unit quaternion ``(..., 4)``, scalar part not negative, of the rotation nearest to a matrix.

    The attitude that fits correlated points best, as of `debrisest.attitude.rotation` by singular
    values, some six times faster: Davenport's eigenvector (Markley, Mortari 2000), its eigenvalue
    by Newton's steps from above. Of a matrix that two rotations are equally near to it is any.
    """
    scale = np.sqrt(np.sum(matrix * matrix, axis=(-2, -1), keepdims=True))
    matrix = matrix / np.maximum(scale, np.finfo(np.float64).tiny)
    davenport = _products(matrix) - np.eye(4)
    linear, constant = -8.0 * np.linalg.det(matrix), np.linalg.det(davenport)
    value = np.full(linear.shape, np.sqrt(3.0))
    for _ in range(NEWTON_STEPS):
        square = value * value
        slope = np.maximum(4.0 * value * (square - 1.0) + linear, 1e-8)
        step = ((square - 2.0) * square + linear * value + constant) / slope
        value -= np.maximum(step, 0.0)
        if not np.any(step > 1e-13):
            break
    above = (value + ABOVE)[..., None, None] * np.eye(4)
    inverse = np.asarray(np.linalg.inv(above - davenport), dtype=np.float64)
    row = _largest_row(inverse)[..., None]
    return _positive((inverse @ (inverse @ row / _length(row[..., 0])[..., None]))[..., 0])


def _components(q: Array) -> tuple[Array, Array, Array, Array]:
    """The four of ``q``, much cheaper than by moving an axis."""
    return q[..., 0], q[..., 1], q[..., 2], q[..., 3]


def _products(matrix: Array) -> Array:
    """``4 q q^T`` of shape ``(..., 4, 4)`` from the elements of ``R(q)``."""
    (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(matrix, (-2, -1), (0, 1))
    elements = [
        *(1.0 + a + e + i, h - f, c - g, d - b),
        *(h - f, 1.0 + a - e - i, b + d, c + g),
        *(c - g, b + d, 1.0 - a + e - i, f + h),
        *(d - b, c + g, f + h, 1.0 - a - e + i),
    ]
    return _gathered(elements).reshape(*np.shape(a), 4, 4)


def _largest_row(products: Array) -> Array:
    """Row ``(..., 4)`` of matrices about ``q q^T`` with the largest component on the diagonal."""
    largest = np.argmax(np.diagonal(products, axis1=-2, axis2=-1), axis=-1)
    return np.take_along_axis(products, largest[..., None, None], axis=-2)[..., 0, :]


def _positive(row: Array) -> Array:
    """Unit quaternions along rows, scalar part not negative."""
    return np.asarray(np.where(row[..., :1] < 0.0, -row, row) / _length(row))


def _gathered(elements: list[Array]) -> Array:
    """Return elements of one shape along a new last axis, much cheaper than by stacking."""
    result = np.empty((*np.shape(elements[0]), len(elements)), elements[0].dtype)
    for k, element in enumerate(elements):
        result[..., k] = element
    return result


def _length(vector: Array) -> Array:
    """Return lengths (..., 1)."""
    return np.asarray(np.sqrt(np.add.reduce(vector * vector, axis=-1, keepdims=True)))


def exp(rotation_vector: Array) -> Array:
    """Unit quaternion of a rotation vector ``(..., 3)`` (axis times angle)."""
    angle = _length(rotation_vector)
    scale = 0.5 * np.sinc(angle / (2.0 * np.pi))
    return np.concatenate([np.cos(0.5 * angle), scale * rotation_vector], axis=-1)


def log(q: Array) -> Array:
    """Shortest rotation vector ``(..., 3)`` of ``q``, of length at most pi."""
    scalar, vector = q[..., :1], q[..., 1:]
    sine = _length(vector)
    angle = 2.0 * np.arctan2(sine, np.abs(scalar))
    ratio = np.divide(angle, sine, out=np.full_like(angle, 2.0), where=sine != 0.0)
    return np.asarray(np.where(scalar < 0.0, -ratio, ratio) * vector)


def angle_between(p: Array, q: Array) -> Array:
    """Angle in ``[0, pi]`` of the rotation that takes ``p`` to ``q``, accurate near 0 and pi."""
    difference = multiply(conjugate(p), q)
    sine = _length(difference[..., 1:])[..., 0]
    return np.asarray(2.0 * np.arctan2(sine, np.abs(difference[..., 0])))
