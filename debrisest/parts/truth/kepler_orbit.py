"""Two-body motion about the Earth."""

from typing import Literal

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import kepler
from debrisest.parts.truth.elements import ClassicalElements, flown


class KeplerOrbit(ClassicalElements):
    """Two-body motion of the target's centre of mass."""

    knows = ("orbit_position", "orbit_velocity")
    kind: Literal["kepler"]

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return position and velocity in Earth-centred inertial axes, the same in every run."""
        return flown(*kepler.propagate(*self.initial_state(), clock.times), len(draws.runs))
