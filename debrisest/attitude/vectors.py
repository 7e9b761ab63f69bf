"""Vector products, batched."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array


def cross(a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
    """Vector product ``(..., 3)``, several times faster than numpy's."""
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    x = a1 * b2 - a2 * b1
    result = np.empty((*x.shape, 3), x.dtype)
    result[..., 0], result[..., 1], result[..., 2] = x, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
    return result


def matrix_of_cross(v: Array) -> Array:
    """``[v]x (..., 3, 3)``, with ``[v]x w = v x w``."""
    x, y, z = v[..., 0], v[..., 1], v[..., 2]
    result = np.zeros((*v.shape, 3))
    result[..., 0, 1], result[..., 0, 2] = -z, y
    result[..., 1, 0], result[..., 1, 2] = z, -x
    result[..., 2, 0], result[..., 2, 1] = -y, x
    return result
