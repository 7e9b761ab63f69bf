"""What is known at first of the orbit of a piece of debris."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws, drawn_about
from debrisest.roles import PerAxis, Positive, SimulationPart


class DrawnOrbit(SimulationPart):
    """An estimate of the debris' orbit at time zero, drawn about the truth."""

    needs = ("orbit_position", "orbit_velocity")
    knows = ("start_orbit_position", "start_orbit_velocity")
    kind: Literal["drawn_orbit"]
    position_sigma_m: PerAxis[Positive]
    """Standard deviation of the position, inertial axes."""
    velocity_sigma_m_s: PerAxis[Positive]
    """Standard deviation of the velocity, inertial axes."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the drawn state and its known sigma."""
        position, velocity = data["orbit_position"][:, 0], data["orbit_velocity"][:, 0]
        sigmas = np.asarray(self.position_sigma_m), np.asarray(self.velocity_sigma_m_s)
        return drawn_about("start_orbit_position", position, sigmas[0], draws) | (
            drawn_about("start_orbit_velocity", velocity, sigmas[1], draws)
        )
