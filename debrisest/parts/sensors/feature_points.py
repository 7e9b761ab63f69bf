"""A sensor of points: the coordinates of the features that are seen."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.roles import NonNegative, SimulationPart
from debrisest.target.visibility import back_face_visible


class FeaturePoints(SimulationPart):
    """Coordinates of the visible features relative to the chaser, in inertial axes."""

    version = 2
    needs = ("true_point_b", "true_normal_b", "true_q_ib", "true_position")
    knows = ("point_noise",)
    measures = ("measured_point",)
    kind: Literal["feature_points"]
    noise_m: NonNegative
    visibility: Literal["back_face", "all"] = "back_face"

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the points (run, time, feature, 3), NaN where one is hidden, and their noise."""
        points, q_ib = data["true_point_b"][:, None], data["true_q_ib"]
        rotated = quaternion.rotate(q_ib[..., None, :], points)
        noise = draws.normal(Stream.MEASUREMENT_NOISE, rotated.shape[1:])
        measured = data["true_position"][..., None, :] + rotated + self.noise_m * noise
        if self.visibility == "back_face":
            seen = back_face_visible(
                points, data["true_normal_b"][:, None], q_ib, -data["true_position"]
            )
            measured[~seen] = np.nan
        return {"measured_point": measured, "point_noise": np.full(len(measured), self.noise_m)}
