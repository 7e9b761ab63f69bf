"""Which way the surface faces at the pixels of a depth image."""

from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.reconstruction.depth import Depth, DepthView
from debrisest.vision.libraries import vision_library

_SMOOTHED_PX = 2.0
_STEP_PX = 4
"""To the neighbours from which a normal is taken."""
_JUMP = 0.01
"""Relative difference of the depth from the smoothed one at which it ends."""


class FacingSurface(NamedTuple):
    """The surface that a depth image shows; NaN where it has none or jumps."""

    points: Array
    """(row, column, 3), camera's axes, m."""
    normals: Array
    """Outward unit vectors (row, column, 3), axes r of the structure."""
    cosine: Array
    """Of the angle between normal and line of sight (row, column)."""


def facing_surface(found: DepthView) -> FacingSurface:
    """Return points and normals of a depth image."""
    view, depth = found.view, found.depth
    v, u = np.indices(depth.shape)
    focal, centre = view.matrix[0, 0], view.matrix[:2, 2]
    rays = np.stack([(u - centre[0]) / focal, (v - centre[1]) / focal, np.ones_like(u)], axis=-1)
    space = rays * _smoothed(depth)[..., None]
    along_u, along_v = (np.full_like(space, np.nan) for _ in range(2))
    n = _STEP_PX
    along_u[:, n:-n] = space[:, 2 * n :] - space[:, : -2 * n]
    along_v[n:-n] = space[2 * n :] - space[: -2 * n]
    normals = np.cross(along_v, along_u)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-30)
    cosine = -(normals * space).sum(-1) / np.linalg.norm(space, axis=-1)
    return FacingSurface(space, normals @ view.rotation, cosine)


def _smoothed(depth: Depth) -> Array:
    """Return the depth, its inverse smoothed, NaN where it jumps.

    What smoothing takes from a surface that bends is given back: what a second smoothing takes of
    the smoothed one, which is the same but for fourth derivatives (twicing, Tukey 1977).
    """
    cv2: Any = vision_library("cv2")
    known = np.isfinite(depth)
    inverse = np.where(known, 1.0 / np.where(known, depth, 1.0), 0.0).astype(np.float32)
    inverse = cv2.medianBlur(inverse, 5)
    known &= inverse > 0.0
    smooth = _averaged(inverse, known)
    known &= np.abs(smooth - inverse) < _JUMP * smooth
    smooth = _averaged(inverse, known)
    twice = 2.0 * smooth - _averaged(smooth, known)
    return np.where(known, 1.0 / np.maximum(twice, 1e-9), np.nan)


def _averaged(values: Depth, known: BoolArray) -> Depth:
    """Return the average (row, column) of what is known nearby."""
    cv2: Any = vision_library("cv2")
    weight = cv2.GaussianBlur(known.astype(np.float32), (0, 0), _SMOOTHED_PX)
    total = cv2.GaussianBlur(np.where(known, values, np.float32(0)), (0, 0), _SMOOTHED_PX)
    averaged: Depth = total / np.maximum(weight, np.float32(1e-3))
    return averaged
