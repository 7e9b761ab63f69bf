"""Orbits about the Earth."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics import kepler, perturbed_orbit
from debrisest.roles import NonNegative, Positive, SimulationPart

EARTH_RADIUS_KM = 6378.137


class ClassicalElements(SimulationPart):
    """A part that flies an orbit, given by classical elements at time zero."""

    semi_major_axis_km: Positive
    eccentricity: Annotated[float, Field(ge=0, lt=1)] = 0.0
    inclination_deg: float = 0.0
    raan_deg: float = 0.0
    argument_of_periapsis_deg: float = 0.0
    true_anomaly_deg: float = 0.0

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


class KeplerOrbit(ClassicalElements):
    """Two-body motion of the target's centre of mass."""

    gives = ("orbit_position", "orbit_velocity")
    kind: Literal["kepler"]

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return position and velocity in Earth-centred inertial axes, the same in every run."""
        return _orbit(*kepler.propagate(*self.initial_state(), clock.times), len(draws.runs))


class PerturbedOrbit(ClassicalElements):
    """The same with the Earth's oblateness, or with random accelerations, or both."""

    gives = ("orbit_position", "orbit_velocity")
    kind: Literal["perturbed"]
    j2: bool = Field(False, description="the Earth's oblateness")
    acceleration_noise_m_s2: NonNegative = Field(
        0.0, description="1 sigma per axis, constant from one epoch to the next"
    )

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return position and velocity in Earth-centred inertial axes."""
        start, runs = self.initial_state(), len(draws.runs)
        if not self.j2 and not self.acceleration_noise_m_s2:
            return _orbit(*kepler.propagate(*start, clock.times), runs)
        noise = draws.normal(Stream.TRUTH, (len(clock.times) - 1, 3))
        return _orbit(
            *perturbed_orbit.propagate(
                *start,
                clock.times,
                perturbed_orbit.J2_EARTH if self.j2 else 0.0,
                self.acceleration_noise_m_s2 * noise,
            ),
            runs,
        )


def _orbit(position: Array, velocity: Array, runs: int) -> Data:
    shape = (runs, *position.shape[-2:])
    return {
        "orbit_position": np.broadcast_to(position, shape),
        "orbit_velocity": np.broadcast_to(velocity, shape),
    }
