"""Orbits about the Earth by classical elements."""

from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Array, Data
from debrisest.dynamics import kepler
from debrisest.roles import Positive, SimulationPart

EARTH_RADIUS_KM = 6378.137


class ClassicalElements(SimulationPart):
    """A part that flies an orbit, given by classical elements at time zero."""

    semi_major_axis_km: Positive
    """Semi-major axis."""
    eccentricity: Annotated[float, Field(ge=0, lt=1)] = 0.0
    """Eccentricity."""
    inclination_deg: float = 0.0
    """Inclination."""
    raan_deg: float = 0.0
    """Right ascension of the ascending node."""
    argument_of_periapsis_deg: float = 0.0
    """Argument of periapsis."""
    true_anomaly_deg: float = 0.0
    """True anomaly."""

    @model_validator(mode="after")
    def _above_the_ground(self) -> "ClassicalElements":
        perigee = self.semi_major_axis_km * (1 - self.eccentricity)
        if perigee < EARTH_RADIUS_KM:
            raise ValueError(
                f"the perigee lies {perigee:g} km from the Earth's centre, below its surface; "
                "semi_major_axis_km is in kilometres"
            )
        return self

    def initial_state(self) -> tuple[Array, Array]:
        """Return position and velocity (3,) at time zero."""
        angles = np.radians(
            [
                self.inclination_deg,
                self.raan_deg,
                self.argument_of_periapsis_deg,
                self.true_anomaly_deg,
            ]
        )
        return kepler.state_from_elements(self.semi_major_axis_km * 1e3, self.eccentricity, *angles)


def flown(position: Array, velocity: Array, runs: int) -> Data:
    """Return an orbit (time, 3) or (run, time, 3) by the names of its datasets, for all runs."""
    shape = (runs, *position.shape[-2:])
    return {
        "orbit_position": np.broadcast_to(position, shape),
        "orbit_velocity": np.broadcast_to(velocity, shape),
    }
