"""What satellites know of the attitude of their cameras."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.roles import NonNegative, SimulationPart


class AttitudeKnowledge(SimulationPart):
    """The attitude of the cameras as an estimator is told, with an error that does not change."""

    needs = ("true_q_ic",)
    knows = ("known_q_ic", "start_attitude_bias")
    kind: Literal["attitude_knowledge"]
    bias_mrad: NonNegative = 0.0
    """Standard deviation of the error about each camera axis."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return ``known_q_ic`` (run, time, observer, 4); the bias is in camera axes."""
        true, sigma = data["true_q_ic"], 1e-3 * self.bias_mrad
        drawn = draws.normal(Stream.MEASUREMENT_NOISE, (true.shape[2], 3))
        bias = quaternion.exp(sigma * drawn)[:, None]
        return {
            "known_q_ic": quaternion.multiply(true, bias),
            "start_attitude_bias": np.zeros(drawn.shape),
            "start_attitude_bias_sigma": np.full(drawn.shape, sigma),
        }
