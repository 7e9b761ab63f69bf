"""A torque-free rotation that differs from run to run."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics.inertia import principal_axes
from debrisest.dynamics.torque_free import torque_free
from debrisest.roles import Limits, Positive, SimulationPart


class RandomTorqueFree(SimulationPart):
    """Attitude and axis drawn evenly, the rate evenly in its logarithm; some spin steadily."""

    needs = ("true_inertia_b",)
    truths = ("true_q_ib", "true_rate_b")
    version = 2
    kind: Literal["random_torque_free"]
    rate_deg_s: Limits[Positive]
    """Limits of the rate at time zero."""
    spin_share: Annotated[float, Field(ge=0, le=1)] = 0.1
    """Share of the runs that spin about a principal axis."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return attitude and rate of the body axes of each run, in closed form."""
        moments, axes = principal_axes(data["true_inertia_b"])
        q_ip = quaternion.normalize(draws.normal(Stream.TRUTH, (4,)))
        direction = draws.normal(Stream.TRUTH, (3,))
        chance = draws.uniform(Stream.TRUTH, (3,))
        spin = np.eye(3)[np.floor(3.0 * chance[:, 0]).astype(int)]
        direction = np.where(chance[:, 1:2] < self.spin_share, spin, direction)
        low, high = np.radians(self.rate_deg_s)
        speed = low * (high / low) ** chance[:, 2:]
        rate_p = speed * direction / np.linalg.norm(direction, axis=-1, keepdims=True)
        q, rate = torque_free(clock.times, q_ip, rate_p, moments)
        q_pb = quaternion.conjugate(quaternion.from_matrix(axes))[:, None]
        return {
            "true_q_ib": quaternion.multiply(q, q_pb),
            "true_rate_b": rate @ np.swapaxes(axes, -1, -2),
        }
