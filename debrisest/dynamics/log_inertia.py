"""Inertia up to its scale as five log-ratios: ``I = exp(S)``, S symmetric and traceless.

The motion without known torques depends on the ratios alone, also under the gravity gradient. The
exponential keeps every tensor positive, and the basis of S is orthonormal, so that the length of
``s (..., 5)`` does not depend on the body axes.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.vectors import matrix_of_cross

_ROOT2, _ROOT6 = np.sqrt(2.0), np.sqrt(6.0)
BASIS = np.array(
    [
        np.diag([1.0, -1.0, 0.0]) / _ROOT2,
        np.diag([1.0, 1.0, -2.0]) / _ROOT6,
        np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]) / _ROOT2,
        np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]) / _ROOT2,
        np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]) / _ROOT2,
    ]
)
"""Orthonormal symmetric traceless matrices (5, 3, 3): two on the diagonal, then xy, xz, yz."""


def inertia(s: Array) -> Array:
    """``exp(S) (..., 3, 3)``, of determinant one."""
    values, vectors = np.linalg.eigh(matrix(s))
    return _rebuilt(np.exp(values), vectors)


def principal(s: Array) -> tuple[Array, Array]:
    """Principal moments (..., 3) of that inertia and axes (..., 3, 3), a proper rotation."""
    values, axes = np.linalg.eigh(matrix(s))
    return np.exp(values), axes * np.sign(np.linalg.det(axes))[..., None, None]


def log_ratios(tensor: Array) -> Array:
    """``s (..., 5)`` of inertia tensors ``(..., 3, 3)`` of any scale; inverse of `inertia`."""
    values, vectors = np.linalg.eigh(tensor)
    flat = _rebuilt(np.log(values), vectors).reshape(*tensor.shape[:-2], 9)
    return np.asarray(flat @ BASIS.reshape(5, 9).T)


def with_derivative(s: Array) -> tuple[Array, Array, Array]:
    """Inertia, its inverse ``(..., 3, 3)``, and the derivative by ``s (..., 5, 3, 3)``.

    By the formula of Daleckii and Krein: in the eigenvectors V of S, with eigenvalues l, the
    derivative along B is ``V ((V^T B V) o G) V^T`` with the divided differences
    ``G_ij = exp((l_i + l_j) / 2) sinh(h) / h``, ``h = (l_i - l_j) / 2``.
    """
    values, vectors = np.linalg.eigh(matrix(s))
    mean = 0.5 * (values[..., :, None] + values[..., None, :])
    half = 0.5 * (values[..., :, None] - values[..., None, :])
    close = np.abs(half) < 1e-4
    wide = np.where(close, 1.0, half)
    ratio = np.where(close, 1.0 + half**2 / 6.0, np.sinh(wide) / wide)
    divided = (np.exp(mean) * ratio)[..., None, :, :]
    frame = vectors[..., None, :, :]
    back = np.swapaxes(frame, -1, -2)
    derivative = frame @ ((back @ BASIS @ frame) * divided) @ back
    return _rebuilt(np.exp(values), vectors), _rebuilt(np.exp(-values), vectors), derivative


def by_turn(s: Array) -> Array:
    """Derivative ``(..., 5, 3)`` of ``s (..., 5)`` by a small turn of the body axes."""
    turns = matrix_of_cross(np.eye(3))
    tensor = matrix(s)[..., None, :, :]
    flat = (tensor @ turns - turns @ tensor).reshape(*s.shape[:-1], 3, 9)
    return np.asarray(BASIS.reshape(5, 9) @ np.swapaxes(flat, -1, -2))


def matrix(s: Array) -> Array:
    """Return ``S (..., 3, 3)``."""
    return np.asarray((s[..., None, :] @ BASIS.reshape(5, 9)).reshape(*s.shape[:-1], 3, 3))


def _rebuilt(values: Array, vectors: Array) -> Array:
    return np.asarray((vectors * values[..., None, :]) @ np.swapaxes(vectors, -1, -2))
