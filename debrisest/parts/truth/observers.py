"""Observers: how the chaser moves about the target."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import relative_motion
from debrisest.roles import SimulationPart, Vector3

_ZERO = [0.0, 0.0, 0.0]
_RELATIVE = "inertial axes, origin at the chaser"


class Hold(SimulationPart):
    """Holds a point in the target's Hill frame: radial outward, along-track, orbit normal."""

    needs = ("orbit_position", "orbit_velocity")
    gives = ("true_position",)
    frames = {"true_position": _RELATIVE}
    kind: Literal["hold"]
    position_m: Vector3

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the target's position relative to the chaser in inertial axes."""
        chaser = relative_motion.hold(
            data["orbit_position"], data["orbit_velocity"], np.array(self.position_m)
        )
        return {"true_position": -chaser}


class Drift(SimulationPart):
    """Drifts freely from a point and a velocity in the target's Hill frame."""

    needs = ("orbit_position", "orbit_velocity")
    gives = ("true_position", "true_velocity")
    frames = {"true_position": _RELATIVE, "true_velocity": _RELATIVE}
    kind: Literal["drift"]
    position_m: Vector3
    velocity_m_s: Vector3 = _ZERO

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the target's position and velocity relative to the chaser, inertial axes."""
        position, velocity = relative_motion.drift(
            data["orbit_position"][0, 0],
            data["orbit_velocity"][0, 0],
            np.array(self.position_m),
            np.array(self.velocity_m_s),
            clock.times,
        )
        runs = len(draws.runs)
        return {"true_position": _seen(position, runs), "true_velocity": _seen(velocity, runs)}


def _seen(chaser: Array, runs: int) -> Array:
    return np.broadcast_to(-chaser, (runs, *chaser.shape))
