"""Places of points from two or more calibrated cameras, least squares of the pixels.

Gauss and Newton for all points at once, from the places nearest to the lines of sight.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.sensors import pinhole

_ITERATIONS = 10
_SETTLED = 1e-6
"""Of a point's distance, the last step; lines that do not meet ahead have no least squares."""
_TOLD = 1e-12
"""Ratio of eigenvalues below which lines of sight are parallel."""


class Triangulated(NamedTuple):
    """Points in the axes of the first camera; NaN where fewer than two cameras see one."""

    point: Array
    """(..., feature, 3), m."""
    cofactor: Array
    """Their covariance for slopes of noise 1 (..., feature, 3, 3), m^2."""
    chi2: Array
    """Sum of squared residuals of the slopes (..., feature)."""
    dof: Array
    """Slopes less the three coordinates (..., feature)."""


def triangulate(rotation: Array, translation: Array, slopes: Array) -> Triangulated:
    """Return points from ``slopes (..., camera, feature, 2)``, x/z and y/z, NaN where not seen.

    ``rotation (camera, 3, 3)`` and ``translation (camera, 3)``, m, take points of the first camera
    to each camera. Points that come out behind a camera that sees them are NaN.
    """
    seen = np.asarray(np.isfinite(slopes).all(axis=-1))
    shown = np.where(seen[..., None], slopes, 0.0)
    enough = seen.sum(axis=-2) >= 2
    point = _nearest(rotation, translation, shown, seen)
    for _ in range(_ITERATIONS):
        residual, derivative, _ = _linearized(rotation, translation, shown, seen, point)
        hold = _squares(derivative)
        pull = np.einsum("...cfij,...cfi->...fj", derivative, residual)
        step = np.linalg.solve(_steady(hold), pull[..., None])[..., 0]
        point = point + step
    settled = np.linalg.norm(step, axis=-1) <= _SETTLED * np.linalg.norm(point, axis=-1)
    residual, derivative, ahead = _linearized(rotation, translation, shown, seen, point)
    hold = _squares(derivative)
    spread = np.linalg.eigvalsh(hold)
    told = enough & ahead & settled & (spread[..., 0] > _TOLD * spread[..., 2])
    cofactor = np.linalg.inv(np.where(told[..., None, None], hold, np.eye(3)))
    return Triangulated(
        np.where(told[..., None], point, np.nan),
        np.where(told[..., None, None], cofactor, np.nan),
        np.where(told, np.sum(residual**2, axis=(-3, -1)), np.nan),
        np.where(told, 2.0 * seen.sum(axis=-2) - 3.0, np.nan),
    )


def _nearest(rotation: Array, translation: Array, slopes: Array, seen: BoolArray) -> Array:
    """Return the points (..., feature, 3) nearest to the lines of sight."""
    sight = np.concatenate([slopes, np.ones((*slopes.shape[:-1], 1))], axis=-1)
    sight = sight @ rotation
    sight /= np.linalg.norm(sight, axis=-1, keepdims=True)
    across = np.eye(3) - sight[..., :, None] * sight[..., None, :]
    across = across * seen[..., None, None]
    place = -(translation[:, None] @ rotation)
    pull = (across @ place[..., None])[..., 0].sum(axis=-3)
    return np.asarray(np.linalg.solve(_steady(across.sum(axis=-4)), pull[..., None])[..., 0])


def _linearized(
    rotation: Array, translation: Array, slopes: Array, seen: BoolArray, point: Array
) -> tuple[Array, Array, BoolArray]:
    """Return residuals (..., camera, feature, 2), derivatives (..., 2, 3), and what lies ahead."""
    local = point[..., None, :, :] @ np.swapaxes(rotation, -1, -2) + translation[:, None]
    ahead = np.asarray(((local[..., 2] > 0.0) | ~seen).all(axis=-2))
    local[..., 2] = np.where(local[..., 2] > 0.0, local[..., 2], 1.0)
    used = seen[..., None]
    residual = np.where(used, slopes - pinhole.project(local, 1.0), 0.0)
    derivative = pinhole.derivative(local, 1.0) @ rotation[:, None]
    return residual, np.where(used[..., None], derivative, 0.0), ahead


def _squares(derivative: Array) -> Array:
    return np.asarray(np.einsum("...cfij,...cfik->...fjk", derivative, derivative))


def _steady(hold: Array) -> Array:
    """Return a matrix that can be solved with, where nothing or too little is seen too."""
    trace = np.trace(hold, axis1=-2, axis2=-1)[..., None, None]
    return np.asarray(hold + (1e-14 * trace + (trace == 0.0)) * np.eye(3))
