"""The angular acceleration of a target, which no camera measures."""

from typing import Literal

import numpy as np

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws, Stream
from debrisest.dynamics import inertia_ratios, kepler
from debrisest.dynamics.relative_orbit import leader_orbit
from debrisest.roles import NonNegative, Positive, SimulationPart


class AngularAcceleration(SimulationPart):
    """The target's angular acceleration in principal axes, as if it could be measured."""

    needs = ("true_q_lt", "true_rate_l", "true_inertia_ratio", "orbit_position", "orbit_velocity")
    knows = ("angular_acceleration_noise",)
    measures = ("measured_angular_acceleration",)
    kind: Literal["angular_acceleration"]
    noise_rad_s2: Positive
    """Standard deviation per axis."""
    from_s: NonNegative = 1.0
    """Time of the first measurement."""

    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the angular acceleration (run, time, 3) and its known noise."""
        start = data["orbit_position"][0, 0], data["orbit_velocity"][0, 0]
        leader = leader_orbit(clock.times, *kepler.shape_and_anomaly(*start))
        rate_i = data["true_rate_l"] + leader.rate[:, None] * np.array([0.0, 0.0, 1.0])
        rate_t = quaternion.rotate(quaternion.conjugate(data["true_q_lt"]), rate_i)
        exact = inertia_ratios.angular_acceleration(rate_t, data["true_inertia_ratio"][:, None])
        errors = draws.normal(Stream.MEASUREMENT_NOISE, exact.shape[1:])
        measured = exact + self.noise_rad_s2 * errors
        measured[:, clock.times < self.from_s] = np.nan
        return {
            "measured_angular_acceleration": measured,
            "angular_acceleration_noise": np.full(len(measured), self.noise_rad_s2),
        }
