"""Motion of a target as an observer on an orbit sees it from its own turning axes."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import kepler
from debrisest.dynamics.relative_orbit import leader_orbit
from debrisest.dynamics.relative_pose import exact_rotation, exact_translation
from debrisest.parts.truth.each_run import each_run
from debrisest.roles import SimulationPart, UnitQuaternion, Vector3

_FRAME = "leader's orbital frame (radially outward, along track, orbit normal), origin at leader"


class SeenFromLeader(SimulationPart):
    """Two orbits and a rotation, in closed form if it is torque-free; the orbit is the leader's.

    Velocity and rate are relative to the leader's orbital frame and in its axes.
    """

    needs = ("true_inertia_ratio", "orbit_position", "orbit_velocity")
    truths = ("true_position", "true_velocity", "true_q_lt", "true_rate_l")
    frames = {"true_position": _FRAME, "true_velocity": _FRAME}
    kind: Literal["seen_from_leader"]
    position_m: Vector3
    """The target's position at time zero, leader's axes."""
    velocity_m_s: Vector3
    """The target's velocity as seen in the leader's turning axes."""
    q_lt: UnitQuaternion = [1.0, 0.0, 0.0, 0.0]
    """Attitude at time zero, target's principal axes to leader's axes."""
    rate_deg_s: Vector3
    """Rate at time zero relative to the leader's axes, in these axes."""
    torque_deg_s2: Vector3 = [0.0, 0.0, 0.0]
    """A constant torque about the target's principal axes, over its moments of inertia."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return position, velocity, attitude and rate relative to the leader."""
        start = data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]
        leader = leader_orbit(clock.times, *kepler.shape_and_anomaly(*start))
        position, velocity = exact_translation(
            clock.times, np.array(self.position_m), np.array(self.velocity_m_s), start
        )
        runs = len(draws.runs)
        q_lt, rate_l = exact_rotation(
            clock.times,
            np.tile(self.q_lt, (runs, 1)),
            np.tile(np.radians(self.rate_deg_s), (runs, 1)),
            data["true_inertia_ratio"],
            leader,
            np.radians(self.torque_deg_s2) if any(self.torque_deg_s2) else None,
        )
        return {
            **each_run({"true_position": position, "true_velocity": velocity}, draws),
            "true_q_lt": q_lt,
            "true_rate_l": rate_l,
        }
