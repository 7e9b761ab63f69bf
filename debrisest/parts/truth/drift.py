"""An observer that drifts freely beside its target."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import relative_motion
from debrisest.parts.truth.each_run import each_run
from debrisest.roles import SimulationPart, Vector3

_RELATIVE = "inertial axes, origin at the chaser"
_ZERO = [0.0, 0.0, 0.0]


class Drift(SimulationPart):
    """Drifts freely from a point and a velocity in the target's Hill frame."""

    needs = ("orbit_position", "orbit_velocity")
    truths = ("true_position", "true_velocity")
    frames = {"true_position": _RELATIVE, "true_velocity": _RELATIVE}
    kind: Literal["drift"]
    position_m: Vector3
    """Position at time zero, Hill frame."""
    velocity_m_s: Vector3 = _ZERO
    """Velocity at time zero as seen in the rotating Hill frame."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the target's position and velocity relative to the chaser, inertial axes."""
        position, velocity = relative_motion.drift(
            data["orbit_position"][0, 0],
            data["orbit_velocity"][0, 0],
            np.array(self.position_m),
            np.array(self.velocity_m_s),
            clock.times,
        )
        return each_run({"true_position": -position, "true_velocity": -velocity}, draws)
