"""Two-body motion about the Earth, disturbed."""

from typing import Literal

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics import kepler, perturbed_orbit
from debrisest.parts.truth.elements import ClassicalElements, flown
from debrisest.roles import NonNegative


class PerturbedOrbit(ClassicalElements):
    """Two-body motion with the Earth's oblateness, or with random accelerations, or both."""

    knows = ("orbit_position", "orbit_velocity")
    kind: Literal["perturbed"]
    j2: bool = False
    """The Earth's oblateness."""
    acceleration_noise_m_s2: NonNegative = 0.0
    """Standard deviation per axis of an acceleration that is drawn anew for each step, in each
    run."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return position and velocity in Earth-centred inertial axes."""
        start, runs = self.initial_state(), len(draws.runs)
        if not self.j2 and not self.acceleration_noise_m_s2:
            return flown(*kepler.propagate(*start, clock.times), runs)
        noise = draws.normal(Stream.TRUTH, (len(clock.times) - 1, 3))
        return flown(
            *perturbed_orbit.propagate(
                *start,
                clock.times,
                perturbed_orbit.J2_EARTH if self.j2 else 0.0,
                self.acceleration_noise_m_s2 * noise,
            ),
            runs,
        )
