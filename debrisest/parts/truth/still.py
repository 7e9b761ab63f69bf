"""An observer beside a target that does not move."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.truth.each_run import each_run
from debrisest.roles import SimulationPart, Vector3


class Still(SimulationPart):
    """Keeps the target at one place, as in a laboratory or over a few minutes of an orbit."""

    truths = ("true_position",)
    frames = {"true_position": "inertial axes, origin at the chaser"}
    kind: Literal["still"]
    target_m: Vector3
    """The target's centre of mass from the chaser, inertial axes."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the target's position relative to the chaser, the same at all times."""
        place = np.broadcast_to(np.array(self.target_m), (len(clock.times), 3))
        return each_run({"true_position": place}, draws)
