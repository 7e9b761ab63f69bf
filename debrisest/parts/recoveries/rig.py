"""What recoveries from pixels share: slopes with their noise, and the way to inertial axes."""

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion

NEEDS = ("measured_pixel", "focal_px", "pixel_noise", "rig_rotation", "rig_translation")
"""Datasets of a calibrated rig."""


def slopes(data: Data) -> Array:
    """Return x/z and y/z of the lines of sight (run, time, camera, feature, 2)."""
    return np.asarray(data["measured_pixel"] / data["focal_px"][:, None, None, None, None])


def to_inertial(data: Data) -> Array:
    """Return what turns the first camera's axes into inertial ones (run, time, 3, 3).

    Where the chaser's attitude is not known, the camera's axes are taken for inertial ones.
    """
    if "known_q_ic" not in data:
        runs, epochs = data["measured_pixel"].shape[:2]
        return np.broadcast_to(np.eye(3), (runs, epochs, 3, 3))
    return quaternion.to_matrix(data["known_q_ic"][:, :, 0])


def slope_variance(data: Data, square: Array, dof: Array) -> Array:
    """Return the variance of slopes (run,): the known one, else that of the residuals.

    ``square`` are sums of squared residuals and ``dof`` their degrees of freedom (run, ...).
    """
    known = data["pixel_noise"] / data["focal_px"]
    rest = tuple(range(1, square.ndim))
    found = np.nansum(square, axis=rest) / np.maximum(np.nansum(dof, axis=rest), 1.0)
    return np.asarray(np.where(np.isnan(known), found, known**2))
