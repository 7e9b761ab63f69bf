"""Measured poses in a text file: of a pose network, of PnP, of motion capture."""

from pathlib import Path
from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.errors import UserError
from debrisest.parts.sources.from_files import FromFiles, one_run
from debrisest.roles import Positive
from debrisest.tracks.colmap import ColmapModel
from debrisest.tracks.types import Tracks


class MeasuredPoses(FromFiles):
    """Attitudes of the body's own axes with their noise, and positions if the file has them."""

    gives = ("measured_q_if", "q_if_noise", "measured_position")
    kind: Literal["poses"]
    sigma_deg: Positive | None = None
    """Standard deviation about each axis, where the file has none."""

    def read(self, folder: Path) -> Data:
        """Return the poses of one run, in inertial axes if the chaser's attitude is given."""
        found = self.measured(folder)
        if isinstance(found, Tracks):
            raise UserError(f"{found.source}: this file holds tracks, not poses; use kind: tracks")
        poses = found.poses if isinstance(found, ColmapModel) else found
        q_ic, told = self.attitude_of_chaser(folder, poses.times)
        given = np.nan if self.sigma_deg is None else np.radians(self.sigma_deg)
        sigma = np.full(len(poses.times), given) if poses.sigma_rad is None else poses.sigma_rad
        q, position = poses.q, poses.position
        if q_ic is not None:
            q = quaternion.multiply(q_ic, q)
            position = None if position is None else quaternion.rotate(q_ic, position)
        data: Data = {"measured_q_if": q, "q_if_noise": sigma}
        if position is not None:
            data["measured_position"] = position
        return one_run(poses.source, poses.times, data, poses.notes + told)
