"""Rotation matrices from matrices that are none."""

import numpy as np

from debrisest.arrays import Array


def nearest_rotation(matrix: Array) -> tuple[Array, Array]:
    """Proper rotation ``(..., 3, 3)`` nearest to a matrix, and the singular values ``(..., 3)``.

    Least Frobenius norm of the difference (Kabsch 1976), hence also the attitude that fits
    correlated points best. It is definite where the second singular value is not zero.
    """
    left, scale, right = np.linalg.svd(matrix)
    left[..., -1] *= np.linalg.det(left @ right)[..., None]
    return left @ right, scale
