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

    ``square`` are sums of squared residuals and ``dof`` their degrees of freedom (run, ...). Their
    median counts, which some wrong pixels do not move, over the median of a chi-square (Wilson and
    Hilferty 1931). NaN where nothing is redundant.
    """
    known = data["pixel_noise"] / data["focal_px"]
    redundant = np.where(dof > 0.0, dof, np.nan)
    share = square / (redundant * (1.0 - 2.0 / (9.0 * redundant)) ** 3)
    found = [np.median(each[np.isfinite(each)]) if np.isfinite(each).any() else np.nan
             for each in share]  # fmt: skip
    return np.asarray(np.where(np.isnan(known), found, known**2))
