"""Inertia tensors in the feature frame as five numbers without constraints.

A tensor is ``exp(S)`` with ``S`` symmetric and traceless, since its scale does not matter; the
numbers are ``S11, S22, S12, S13, S23``. Any ``S`` gives a positive tensor. This differs from
`debrisest.dynamics.log_inertia` in its basis, which is not orthonormal: first guesses, their
variances and stored estimates of ``log_inertia`` count in these numbers.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.dynamics.inertia import principal_axes

_BASIS = np.array(
    [
        [1.0, 0, 0, 0, 0, 0, 0, 0, -1],
        [0, 0, 0, 0, 1, 0, 0, 0, -1],
        [0, 1, 0, 1, 0, 0, 0, 0, 0],
        [0, 0, 1, 0, 0, 0, 1, 0, 0],
        [0, 0, 0, 0, 0, 1, 0, 1, 0],
    ]
)
"""``S`` of each coordinate, row after row."""

_BISECTIONS = 40


def log_inertia(inertia: Array) -> Array:
    """Return the coordinates (..., 5) of tensors (..., 3, 3) of any scale."""
    moments, axes = principal_axes(inertia)
    logs = np.log(moments)
    logs = logs - logs.mean(axis=-1, keepdims=True)
    matrix = (axes * logs[..., None, :]) @ np.swapaxes(axes, -1, -2)
    return np.asarray(matrix[..., [0, 1, 0, 0, 1], [0, 1, 1, 2, 2]])


def principal_logs(coordinates: Array) -> tuple[Array, Array]:
    """Return logarithms (..., 3) of the moments and the principal axes ``R_fb (..., 3, 3)``.

    Of coordinates (..., 5) that are not finite: NaN, and the feature frame's own axes.
    """
    finite = np.isfinite(coordinates).all(axis=-1, keepdims=True)
    logs, axes = principal_axes(log_tensor(np.where(finite, coordinates, 0.0)))
    return np.where(finite, logs, np.nan), axes


def log_tensor(coordinates: Array) -> Array:
    """Return ``S (..., 3, 3)`` of coordinates (..., 5)."""
    flat = coordinates @ _BASIS
    return np.asarray(flat.reshape(*coordinates.shape[:-1], 3, 3))


def possible(coordinates: Array) -> Array:
    """Return coordinates (..., 5) of bodies: the triangle inequality of the moments holds.

    Where the largest moment would exceed the sum of the others, all of ``S`` is scaled.
    """
    logs, _ = principal_logs(coordinates)
    return np.asarray(coordinates * _possible_share(logs)[..., None])


def _possible_share(logs: Array) -> Array:
    """Share (...) of ``logs (..., 3)``, up to 1, that obeys the triangle inequality, by bisection.

    ``1 - exp(s (b - a)) - exp(s (c - a))`` with ``a`` the largest grows with the share ``s``.
    """
    gaps = logs.max(axis=-1, keepdims=True) - logs
    low, high = np.zeros(logs.shape[:-1]), np.ones(logs.shape[:-1])
    possible = np.exp(-gaps).sum(axis=-1) >= 2.0
    for _ in range(0 if possible.all() else _BISECTIONS):
        middle = 0.5 * (low + high)
        inside = np.exp(-middle[..., None] * gaps).sum(axis=-1) >= 2.0
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    return np.where(possible, 1.0, low)
