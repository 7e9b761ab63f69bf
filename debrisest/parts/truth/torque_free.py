"""Rotation of a rigid body without torque."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics.inertia import principal_axes
from debrisest.dynamics.torque_free import torque_free
from debrisest.parts.truth.each_run import each_body
from debrisest.roles import SimulationPart, UnitQuaternion, Vector3


class TorqueFree(SimulationPart):
    """Rotation without torque, in closed form."""

    needs = ("true_inertia_b",)
    truths = ("true_q_ib", "true_rate_b")
    version = 3
    kind: Literal["torque_free"]
    q_ib: UnitQuaternion = [1.0, 0.0, 0.0, 0.0]
    """Attitude at time zero."""
    rate_deg_s: Vector3
    """Rate at time zero, body axes."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return attitude and rate of the body axes, the same in every run of the same body."""
        return each_body(lambda inertia: self._rotation(inertia, clock), data["true_inertia_b"])

    def _rotation(self, inertia: Array, clock: Clock) -> dict[str, Array]:
        moments, axes = principal_axes(inertia)
        q_bp = quaternion.from_matrix(axes)
        q_ip, rate_p = torque_free(
            clock.times,
            quaternion.multiply(np.array(self.q_ib), q_bp),
            np.radians(self.rate_deg_s) @ axes,
            moments,
        )
        q_ib = quaternion.multiply(q_ip, quaternion.conjugate(q_bp))
        return {"true_q_ib": q_ib, "true_rate_b": rate_p @ axes.T}
