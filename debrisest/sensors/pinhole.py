"""A pinhole camera that looks along its z axis; pixels count from the middle of the image.

Source: Li et al., Eqs 5-7, without an offset between camera and body. The printed Eq 7 has no test
of the depth: a point behind the camera has pixels too, which `in_view` refuses.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray

BODY_TO_CAMERA = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Turns body vectors into camera vectors (Eq 6): the camera looks along the body's -y."""


def project(point_c: Array, scale: Array | float) -> Array:
    """Pixel ``(..., 2)`` of points ``(..., 3)``, m, in camera axes; NaN at depth zero.

    ``scale (...,)`` is the focal length in pixels. Points behind the camera have a pixel as well.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = np.where(point_c[..., 2:] == 0.0, np.nan, point_c[..., 2:])
        return np.asarray(np.asarray(scale)[..., None] * (point_c[..., :2] / depth))


def derivative(point_c: Array, scale: Array | float) -> Array:
    """Derivative ``(..., 2, 3)`` of `project` with respect to the point, pixels per metre."""
    slope = project(point_c, 1.0)
    shape = np.broadcast_shapes(slope.shape[:-1], np.shape(scale))
    result = np.zeros((*shape, 2, 3))
    result[..., 0, 0] = result[..., 1, 1] = 1.0
    result[..., 2] = -slope
    per_depth = scale / np.where(point_c[..., 2] == 0.0, np.nan, point_c[..., 2])
    return np.asarray(per_depth[..., None, None] * result)


def derivative_through(point_c: Array, scale: Array | float, matrix: Array) -> Array:
    """`derivative` times matrices ``(..., 3, n)``: by what moves the point as they have it."""
    depth = np.where(point_c[..., 2:] == 0.0, np.nan, point_c[..., 2:])
    along = (point_c[..., :2] / depth)[..., None] * matrix[..., 2:, :]
    return np.asarray(
        (np.asarray(scale)[..., None] / depth)[..., None] * (matrix[..., :2, :] - along)
    )


def in_view(point_c: Array, pixel: Array, half_size: Array) -> BoolArray:
    """Return where points ``(..., 3)`` are in front and their pixels inside ``half_size (2,)``.

    The border itself is inside; NaN is not in view.
    """
    inside = np.all(np.abs(pixel) <= half_size, axis=-1)
    return np.asarray(inside & (point_c[..., 2] > 0.0))
