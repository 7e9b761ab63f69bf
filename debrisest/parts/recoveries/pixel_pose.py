"""Poses of a known body from the pixels of each epoch."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.batch.pixel_pose import Camera, Poses, poses_from_pixels
from debrisest.clock import Clock
from debrisest.outcome import Outcome, sentences
from debrisest.parts.recoveries.rig import NEEDS, slope_variance, slopes, to_inertial
from debrisest.roles import RecoveryPart

_TYPICAL = 1e-3
"""Noise of slopes where none is known; covariances are scaled by the residuals afterwards."""


class PoseStatus(Outcome):
    """Of which epochs there are poses; `sentence` tells the user."""

    EVERY = 0, "a pose at every epoch"
    SOME = 1, "poses at some epochs: the others show fewer than three known points, or one line"


class PixelPose(RecoveryPart):
    """Pose of each epoch from one or more calibrated cameras and the known geometry."""

    needs = (*NEEDS, "known_point_f")
    gives = ("measured_q_if", "measured_q_if_covariance", "measured_position")
    kind: Literal["pixel_pose"]

    def recover(self, data: Data, clock: Clock) -> Data:
        """Return attitudes and positions in inertial axes, from the chaser, with a covariance."""
        found = [_poses(data, run) for run in range(len(data["measured_pixel"]))]
        poses = Poses(*(np.stack(parts) for parts in zip(*found)))
        seen = np.isfinite(poses.q[..., 0])
        if not seen.any():
            raise ValueError(
                "no epoch tells a pose: three points of the known geometry are needed in one image"
            )
        turn = to_inertial(data)
        assumed = _noise(data)[:, None] ** 2
        scale = slope_variance(data, assumed * poses.chi2, poses.dof)[:, None] / assumed
        covariance = scale[..., None, None] * poses.covariance[..., :3, :3]
        status = np.where(seen.all(axis=-1), PoseStatus.EVERY, PoseStatus.SOME)
        return {
            "measured_q_if": quaternion.multiply(quaternion.from_matrix(turn), poses.q),
            "measured_q_if_covariance": turn @ covariance @ np.swapaxes(turn, -1, -2),
            "measured_position": (turn @ poses.position[..., None])[..., 0],
            "status": sentences(status, PoseStatus),
        }

    def assess(self, data: Data) -> Data:
        """Return the share of epochs with a pose."""
        return {"coverage": np.isfinite(data["measured_q_if"][..., 0]).mean(axis=-1)}


def _poses(data: Data, run: int) -> Poses:
    """Return the poses of a run in the axes of the first camera."""
    rotation, translation = data["rig_rotation"][run], data["rig_translation"][run]
    cameras = [
        Camera(np.ones(2), np.zeros(2), -turn.T @ shift, turn.T)
        for turn, shift in zip(rotation, translation)
    ]
    noise = float(_noise(data)[run])
    return poses_from_pixels(cameras, slopes(data)[run], noise, data["known_point_f"][run])


def _noise(data: Data) -> Array:
    known = data["pixel_noise"] / data["focal_px"]
    return np.where(np.isnan(known), _TYPICAL, known)
