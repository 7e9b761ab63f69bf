"""Two-body motion about the Earth, disturbed."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics import kepler, perturbed_orbit
from debrisest.dynamics.drag import Drag
from debrisest.parts.truth.elements import EARTH_RADIUS_KM, ClassicalElements, flown
from debrisest.roles import Keys, NonNegative, PerAxis, Positive, Vector3


class Air(Keys):
    """An exponential atmosphere that turns with the Earth, and what it acts on."""

    area_to_mass_m2_kg: Positive
    """Area across the flow over the mass."""
    drag_coefficient: Positive = 2.2
    """Drag coefficient."""
    density_kg_m3: Positive
    """Density of the air at `altitude_km`."""
    altitude_km: NonNegative
    """Height above the equator at which the air has that density."""
    scale_height_km: Positive
    """Height over which the density falls by e."""

    def drag(self) -> Drag:
        """Return the same in SI units."""
        return Drag(
            self.drag_coefficient * self.area_to_mass_m2_kg,
            self.density_kg_m3,
            (EARTH_RADIUS_KM + self.altitude_km) * 1e3,
            self.scale_height_km * 1e3,
        )


class PerturbedOrbit(ClassicalElements):
    """Two-body motion with the Earth's oblateness, drag, constant and random accelerations."""

    knows = ("orbit_position", "orbit_velocity")
    kind: Literal["perturbed"]
    j2: bool = False
    """The Earth's oblateness."""
    air: Air | None = None
    """Drag."""
    acceleration_m_s2: Vector3 = [0.0, 0.0, 0.0]
    """A constant acceleration, inertial axes: the Sun's pressure (4.6e-6 N/m2 on what absorbs it),
    say."""
    acceleration_noise_m_s2: PerAxis[NonNegative] = 0.0
    """Standard deviation of an acceleration, inertial axes, that is drawn anew for each step, in
    each run."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return position and velocity in Earth-centred inertial axes."""
        start, runs = self.initial_state(), len(draws.runs)
        random = bool(np.any(self.acceleration_noise_m_s2))
        if not (self.j2 or self.air or random or any(self.acceleration_m_s2)):
            return flown(*kepler.propagate(*start, clock.times), runs)
        noise = draws.normal(Stream.TRUTH, (len(clock.times) - 1, 3))
        return flown(
            *perturbed_orbit.propagate(
                *start,
                clock.times,
                perturbed_orbit.J2_EARTH if self.j2 else 0.0,
                np.asarray(self.acceleration_noise_m_s2) * noise + self.acceleration_m_s2,
                drag=None if self.air is None else self.air.drag(),
            ),
            runs,
        )
