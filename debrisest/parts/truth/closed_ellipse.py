"""An observer on a closed relative orbit about its target."""

from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import clohessy_wiltshire
from debrisest.parts.truth.each_run import each_run
from debrisest.roles import SimulationPart, Vector3

HILL = "Hill frame (radially outward, along track, orbit normal), origin at the target"
_OPEN = 1e-3
"""Part of the velocity's size that may be missing or too much for a closed ellipse."""


def apart(position: list[float]) -> list[float]:
    """Return the position if a camera there can look at the target; ValueError, in a sentence."""
    if position[0] == position[1] == 0:
        raise ValueError(
            "the chaser must not stand in the target, where the range is zero, nor straight above "
            "the orbit, where the camera's azimuth is undefined"
        )
    return position


class ClosedEllipse(SimulationPart):
    """Drifts on the closed relative ellipse through a point; linearised, the orbit is a circle."""

    needs = ("orbit_position", "orbit_velocity")
    truths = ("chaser_position_h", "chaser_velocity_h")
    frames = {"chaser_position_h": HILL, "chaser_velocity_h": HILL}
    tried = True
    kind: Literal["closed_ellipse"]
    position_m: Annotated[Vector3, AfterValidator(apart)]
    """Position at time zero, Hill frame; not on the frame's third axis."""
    velocity_m_s: Vector3
    """Velocity at time zero as seen in the rotating Hill frame."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the chaser's motion relative to the target, the same in every run."""
        mean_motion = self._mean_motion(data)
        position, velocity = clohessy_wiltshire.propagate(
            np.array(self.position_m), np.array(self.velocity_m_s), mean_motion, clock.times
        )
        return each_run({"chaser_position_h": position, "chaser_velocity_h": velocity}, draws)

    def _mean_motion(self, data: Data) -> float:
        """Mean motion of the target; ValueError if its orbit or the ellipse is not as needed."""
        start = data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]
        mean_motion = clohessy_wiltshire.mean_motion_of(*start)
        closing = clohessy_wiltshire.closing_velocity(np.array(self.position_m), mean_motion)
        along, needed = self.velocity_m_s[1], float(closing)
        size = max(float(np.linalg.norm(self.velocity_m_s)), abs(needed))
        if abs(along - needed) > _OPEN * size:
            raise ValueError(
                f"the relative orbit is open: the along-track velocity is {along:.6g} m/s, a "
                f"closed ellipse through this point needs {needed:.6g} m/s (-2 n x); kind "
                "relative_orbit may be open"
            )
        return mean_motion
