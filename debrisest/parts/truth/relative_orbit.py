"""An observer on a relative orbit of any shape about its target."""

from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics.relative_pose import exact_translation
from debrisest.parts.truth.closed_ellipse import HILL, apart
from debrisest.parts.truth.each_run import each_run
from debrisest.roles import SimulationPart, Vector3


class RelativeOrbit(SimulationPart):
    """Flies freely from a point and a velocity: two Kepler orbits, so that it may drift away.

    The target's orbit may have any eccentricity; estimators that have the linearised motion about a
    circle refuse more than 0.001.
    """

    needs = ("orbit_position", "orbit_velocity")
    truths = ("chaser_position_h", "chaser_velocity_h")
    frames = {"chaser_position_h": HILL, "chaser_velocity_h": HILL}
    tried = True
    kind: Literal["relative_orbit"]
    position_m: Annotated[Vector3, AfterValidator(apart)]
    """Position at time zero, Hill frame; not on the frame's third axis."""
    velocity_m_s: Vector3
    """Velocity at time zero as seen in the rotating Hill frame."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the chaser's motion relative to the target, the same in every run."""
        position, velocity = exact_translation(
            clock.times,
            np.array(self.position_m),
            np.array(self.velocity_m_s),
            (data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]),
        )
        return each_run({"chaser_position_h": position, "chaser_velocity_h": velocity}, draws)
