"""Linear algebra of positive matrices whose unknowns differ by orders of magnitude."""

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.covariance import solve


def scaled_solve(matrix: Array, right: Array) -> Array:
    """Solution ``(run, n_e)``; NaN where the matrix is singular."""
    scale = np.diagonal(matrix, 0, -2, -1) ** -0.5
    scaled = scale[..., :, None] * matrix * scale[..., None, :]
    return scale * solve(scaled, (scale * right)[..., None])[..., 0]


def scaled_inverse(matrix: Array) -> Array:
    """Inverse ``(run, n_e, n_e)``, symmetric; NaN where the matrix is singular."""
    scale = np.diagonal(matrix, 0, -2, -1) ** -0.5
    both = scale[..., :, None] * scale[..., None, :]
    inverse = solve(both * matrix, np.broadcast_to(np.eye(matrix.shape[-1]), matrix.shape))
    return 0.5 * both * (inverse + np.swapaxes(inverse, -1, -2))
