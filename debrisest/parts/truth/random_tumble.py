"""A rotation that differs from run to run."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics.gravity_gradient import tumble
from debrisest.dynamics.kepler import ellipse
from debrisest.roles import Limits, NonNegative, SimulationPart


class RandomTumble(SimulationPart):
    """Attitude and axis drawn evenly, rate between two limits, under the gravity gradient."""

    needs = ("true_inertia_b", "orbit_position", "orbit_velocity")
    truths = ("true_q_ib", "true_rate_b")
    kind: Literal["random_tumble"]
    rate_deg_s: Limits[NonNegative]
    """Limits of the rate at time zero."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return attitude and rate of the body axes of each run."""
        orbit = ellipse(data["orbit_position"][0, 0], data["orbit_velocity"][0, 0])
        q_ib = quaternion.normalize(draws.normal(Stream.TRUTH, (4,)))
        axis = draws.normal(Stream.TRUTH, (3,))
        axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
        low, high = np.radians(self.rate_deg_s)
        rate = (low + (high - low) * draws.uniform(Stream.TRUTH, (1,))) * axis
        motions = [
            tumble(
                clock.times,
                *start,
                lambda time: orbit.positions(np.array([time]))[0],
            )
            for start in zip(q_ib, rate, data["true_inertia_b"])
        ]
        attitudes, rates = zip(*motions)
        return {"true_q_ib": np.stack(attitudes), "true_rate_b": np.stack(rates)}
