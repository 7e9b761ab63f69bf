"""Principal axes of inertia tensors."""

import numpy as np

from debrisest.arrays import Array


def principal_axes(inertia: Array) -> tuple[Array, Array]:
    """Return principal moments (..., 3) and axes (..., 3, 3), a proper rotation R_bp.

    A tensor that is diagonal already keeps its axes and their order; otherwise the moments ascend.
    """
    moments, axes = np.linalg.eigh(inertia)
    axes = axes * np.sign(np.linalg.det(axes))[..., None, None]
    diagonal = np.diagonal(inertia, axis1=-2, axis2=-1)
    kept = np.all(inertia == diagonal[..., None] * np.eye(3), axis=(-2, -1))
    return (
        np.where(kept[..., None], diagonal, moments),
        np.where(kept[..., None, None], np.eye(3), axes),
    )
