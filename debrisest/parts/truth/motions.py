"""Motions: how the target rotates."""

from typing import Literal

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics.gravity_gradient import tumble
from debrisest.dynamics.inertia import principal_axes
from debrisest.dynamics.kepler import propagate
from debrisest.dynamics.torque_free import torque_free
from debrisest.roles import SimulationPart, UnitQuaternion, Vector3


class TorqueFree(SimulationPart):
    """Rotation without torque, in closed form."""

    needs = ("true_inertia_b",)
    gives = ("true_q_ib", "true_rate_b")
    kind: Literal["torque_free"]
    q_ib: UnitQuaternion = [1.0, 0.0, 0.0, 0.0]
    rate_deg_s: Vector3

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return attitude and rate of the body axes, the same in every run."""
        moments, axes = principal_axes(data["true_inertia_b"][0])
        q_bp = quaternion.from_matrix(axes)
        q_ip, rate_p = torque_free(
            clock.times,
            quaternion.multiply(np.array(self.q_ib), q_bp),
            np.radians(self.rate_deg_s) @ axes,
            moments,
        )
        q_ib = quaternion.multiply(q_ip, quaternion.conjugate(q_bp))
        return _truth(q_ib, rate_p @ axes.T, len(draws.runs))


class GravityGradient(SimulationPart):
    """Rotation under the gravity-gradient torque, integrated numerically; needs an orbit."""

    needs = ("true_inertia_b", "orbit_position", "orbit_velocity")
    gives = ("true_q_ib", "true_rate_b")
    kind: Literal["gravity_gradient"]
    q_ib: UnitQuaternion = [1.0, 0.0, 0.0, 0.0]
    rate_deg_s: Vector3

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return attitude and rate of the body axes, the same in every run."""
        position, velocity = data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]
        q_ib, rate_b = tumble(
            clock.times,
            np.array(self.q_ib),
            np.radians(self.rate_deg_s),
            data["true_inertia_b"][0],
            lambda time: propagate(position, velocity, np.array([time]))[0][0],
        )
        return _truth(q_ib, rate_b, len(draws.runs))


def _truth(q_ib: Array, rate_b: Array, runs: int) -> Data:
    return {
        "true_q_ib": np.broadcast_to(q_ib, (runs, *q_ib.shape)),
        "true_rate_b": np.broadcast_to(rate_b, (runs, *rate_b.shape)),
    }
