"""Rotation of a rigid body on an orbit."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics.gravity_gradient import tumble
from debrisest.dynamics.kepler import Ellipse, ellipse
from debrisest.parts.truth.each_run import each_body
from debrisest.roles import SimulationPart, UnitQuaternion, Vector3


class GravityGradient(SimulationPart):
    """Rotation under the gravity-gradient torque, integrated numerically; needs an orbit."""

    needs = ("true_inertia_b", "orbit_position", "orbit_velocity")
    truths = ("true_q_ib", "true_rate_b")
    version = 2
    kind: Literal["gravity_gradient"]
    q_ib: UnitQuaternion = [1.0, 0.0, 0.0, 0.0]
    """Attitude at time zero."""
    rate_deg_s: Vector3
    """Rate at time zero, body axes."""
    torque_n_m: Vector3 = [0.0, 0.0, 0.0]
    """A further torque, constant in body axes; it wants an inertia in kg m2."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return attitude and rate of the body axes, the same in every run of the same body."""
        orbit = ellipse(data["orbit_position"][0, 0], data["orbit_velocity"][0, 0])
        inertias = data["true_inertia_b"]
        return each_body(lambda inertia: self._rotation(inertia, orbit, clock), inertias)

    def _rotation(self, inertia: Array, orbit: Ellipse, clock: Clock) -> dict[str, Array]:
        q_ib, rate_b = tumble(
            clock.times,
            np.array(self.q_ib),
            np.radians(self.rate_deg_s),
            inertia,
            lambda time: orbit.positions(np.array([time]))[0],
            np.array(self.torque_n_m),
        )
        return {"true_q_ib": q_ib, "true_rate_b": rate_b}
