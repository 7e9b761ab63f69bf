"""Orbits of the target about the Earth."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import kepler
from debrisest.roles import Positive, SimulationPart

EARTH_RADIUS_KM = 6378.137


class KeplerOrbit(SimulationPart):
    """Two-body motion of the target's centre of mass, from classical elements at time zero."""

    gives = ("orbit_position", "orbit_velocity")
    kind: Literal["kepler"]
    semi_major_axis_km: Positive
    eccentricity: Annotated[float, Field(ge=0, lt=1)] = 0.0
    inclination_deg: float = 0.0
    raan_deg: float = 0.0
    argument_of_periapsis_deg: float = 0.0
    true_anomaly_deg: float = 0.0

    @model_validator(mode="after")
    def _above_the_ground(self) -> "KeplerOrbit":
        perigee = self.semi_major_axis_km * (1 - self.eccentricity)
        if perigee < EARTH_RADIUS_KM:
            raise ValueError(
                f"the perigee lies {perigee:g} km from the Earth's centre, below its surface; "
                "semi_major_axis_km is in kilometres"
            )
        return self

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return position and velocity in Earth-centred inertial axes, the same in every run."""
        angles = np.radians(
            [
                self.inclination_deg,
                self.raan_deg,
                self.argument_of_periapsis_deg,
                self.true_anomaly_deg,
            ]
        )
        start = kepler.state_from_elements(
            self.semi_major_axis_km * 1e3, self.eccentricity, *angles
        )
        position, velocity = kepler.propagate(*start, clock.times)
        shape = (len(draws.runs), *position.shape)
        return {
            "orbit_position": np.broadcast_to(position, shape),
            "orbit_velocity": np.broadcast_to(velocity, shape),
        }
