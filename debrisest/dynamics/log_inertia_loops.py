"""Inertia of log-ratios, and its derivative, as plain loops.

The formula is that of `log_inertia.with_derivative`; the eigenvectors are those of Jacobi's turns.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.dynamics.log_inertia import BASIS

_SWEEPS = 12
"""After six at most nothing is left beside the diagonal."""
_CLOSE = 1e-4


@compiled
def with_derivative(s: Array) -> tuple[Array, Array, Array]:
    """Return inertia, its inverse (run, 3, 3), and the derivative (run, 5, 3, 3) by ``s (run, 5)``.

    A run that is not finite has NaN.
    """
    runs = len(s)
    inertia, inverse = np.empty((runs, 3, 3)), np.empty((runs, 3, 3))
    derivative, matrix, axes = np.empty((runs, 5, 3, 3)), np.empty((3, 3)), np.empty((3, 3))
    divided, turned = np.empty((3, 3)), np.empty((3, 3))
    for run in range(runs):
        for i in range(3):
            for j in range(3):
                axes[i, j], matrix[i, j] = (1.0 if i == j else 0.0), 0.0
                for b in range(5):
                    matrix[i, j] += s[run, b] * BASIS[b, i, j]
        _diagonalise(matrix, axes)
        for i in range(3):
            for j in range(3):
                inertia[run, i, j] = inverse[run, i, j] = 0.0
                for k in range(3):
                    both = axes[i, k] * axes[j, k]
                    inertia[run, i, j] += both * np.exp(matrix[k, k])
                    inverse[run, i, j] += both * np.exp(-matrix[k, k])
                half = 0.5 * (matrix[i, i] - matrix[j, j])
                ratio = 1.0 + half**2 / 6.0 if abs(half) < _CLOSE else np.sinh(half) / half
                divided[i, j] = np.exp(0.5 * (matrix[i, i] + matrix[j, j])) * ratio
        for b in range(5):
            _turned(axes, BASIS[b], divided, turned)
            _back(axes, turned, derivative[run, b])
    return inertia, inverse, derivative


@compiled
def _diagonalise(matrix: Array, axes: Array) -> None:
    """Turn a symmetric matrix (3, 3) to its eigenvectors, whose columns the axes become."""
    for _ in range(_SWEEPS):
        for i, j in ((0, 1), (0, 2), (1, 2)):
            if matrix[i, j] == 0.0:
                continue
            ratio = (matrix[j, j] - matrix[i, i]) / (2.0 * matrix[i, j])
            tangent = 1.0 / (abs(ratio) + np.sqrt(ratio**2 + 1.0))
            tangent = -tangent if ratio < 0.0 else tangent
            cosine = 1.0 / np.sqrt(tangent**2 + 1.0)
            sine = tangent * cosine
            for k in range(3):
                a, b = matrix[k, i], matrix[k, j]
                matrix[k, i], matrix[k, j] = cosine * a - sine * b, sine * a + cosine * b
            for k in range(3):
                a, b = matrix[i, k], matrix[j, k]
                matrix[i, k], matrix[j, k] = cosine * a - sine * b, sine * a + cosine * b
                a, b = axes[k, i], axes[k, j]
                axes[k, i], axes[k, j] = cosine * a - sine * b, sine * a + cosine * b
            matrix[i, j] = matrix[j, i] = 0.0


@compiled
def _turned(axes: Array, matrix: Array, factors: Array, result: Array) -> None:
    """Write a matrix (3, 3) as the axes see it, each element by its factor."""
    for i in range(3):
        for j in range(3):
            result[i, j] = 0.0
            for k in range(3):
                for m in range(3):
                    result[i, j] += axes[k, i] * matrix[k, m] * axes[m, j]
            result[i, j] *= factors[i, j]


@compiled
def _back(axes: Array, matrix: Array, result: Array) -> None:
    """Write a matrix (3, 3) that the axes see as it is."""
    for i in range(3):
        for j in range(3):
            result[i, j] = 0.0
            for k in range(3):
                for m in range(3):
                    result[i, j] += axes[i, k] * matrix[k, m] * axes[j, m]
