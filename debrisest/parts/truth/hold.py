"""An observer that stays where it is beside its target."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import relative_motion
from debrisest.roles import SimulationPart, Vector3

_RELATIVE = "inertial axes, origin at the chaser"


class Hold(SimulationPart):
    """Holds a point in the target's Hill frame: radial outward, along-track, orbit normal."""

    needs = ("orbit_position", "orbit_velocity")
    truths = ("true_position",)
    frames = {"true_position": _RELATIVE}
    kind: Literal["hold"]
    position_m: Vector3
    """The chaser's position from the target, Hill frame."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the target's position relative to the chaser in inertial axes."""
        chaser = relative_motion.hold(
            data["orbit_position"], data["orbit_velocity"], np.array(self.position_m)
        )
        return {"true_position": -chaser}
