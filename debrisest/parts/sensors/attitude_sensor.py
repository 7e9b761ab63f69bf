"""A sensor of the target's attitude: what a pose network or a perspective solver gives."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Data
from debrisest.assessment.attitude import true_feature_attitude
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.roles import Positive, SimulationPart


class AttitudeSensor(SimulationPart):
    """Attitudes of the feature frame with a small turn about each inertial axis as their error.

    Some are missing by chance, and some are wild: any attitude at all.
    """

    needs = ("true_q_ib", "true_point_b")
    measures = ("measured_q_if", "q_if_noise")
    kind: Literal["attitude_sensor"]
    noise_deg: Positive
    """Standard deviation of the turn about each inertial axis that is its error."""
    missing_share: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Share of the epochs without an attitude."""
    wild_share: Annotated[float, Field(ge=0, le=1)] = 0.0
    """Share of the attitudes that have nothing to do with the body's."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the attitudes (run, time, 4), NaN where one is missing, and their noise."""
        true, sigma = true_feature_attitude(data), float(np.radians(self.noise_deg))
        error = sigma * draws.normal(Stream.MEASUREMENT_NOISE, (true.shape[1], 3))
        measured = quaternion.multiply(quaternion.exp(error), true)
        chance = draws.uniform(Stream.CLUTTER, (true.shape[1], 2))
        anything = quaternion.normalize(draws.normal(Stream.CLUTTER, (true.shape[1], 4)))
        measured = np.where(chance[..., :1] < self.wild_share, anything, measured)
        measured[chance[..., 1] < self.missing_share] = np.nan
        return {"measured_q_if": measured, "q_if_noise": np.full(true.shape[:2], sigma)}
