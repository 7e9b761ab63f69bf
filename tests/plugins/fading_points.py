"""A sensor: points of the features, each seen with a given probability."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.quantity import Quantity
from debrisest.roles import Positive, SimulationPart

QUANTITIES = {"fading": Quantity(("run", "time_s"), "1", "share of the features not seen", "1")}


class FadingPoints(SimulationPart):
    """Coordinates of features in inertial axes, NaN where one is not seen."""

    needs = ("true_point_b", "true_q_ib", "true_position")
    knows = ("point_noise",)
    measures = ("measured_point", "fading")
    kind: Literal["fading_points"]
    noise_m: Positive
    seen: Annotated[float, Field(gt=0, le=1)] = 0.9

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the points (run, time, feature, 3) and their noise."""
        turned = quaternion.rotate(data["true_q_ib"][..., None, :], data["true_point_b"][:, None])
        exact = data["true_position"][..., None, :] + turned
        measured = exact + self.noise_m * draws.normal(Stream.MEASUREMENT_NOISE, exact.shape[1:])
        lost = draws.uniform(Stream.CLUTTER, exact.shape[1:3]) >= self.seen
        measured[lost] = np.nan
        noise = np.full(len(measured), self.noise_m)
        return {"measured_point": measured, "point_noise": noise, "fading": lost.mean(axis=-1)}
