"""Simulation parts without a scenario."""

from collections.abc import Callable

import numpy as np
import pytest

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.truth.kepler_orbit import KeplerOrbit
from debrisest.parts.truth.random_points import RandomPoints
from debrisest.parts.truth.seen_from_leader import SeenFromLeader

SLOW = [-0.1, -0.1, 0.034]


@pytest.fixture(scope="session")
def simulated() -> Callable:
    """Simulate a random target seen from an eccentric orbit, and further parts."""

    def run(*parts, runs=4, duration=10.0, step=1.0, rate=SLOW, first=0, seed=1, torque=(0, 0, 0)):
        clock = Clock.regular(duration, step)
        draws = Draws(seed, "case", list(range(first, first + runs)))
        data = {"time_s": clock.times, "run": np.arange(runs)}
        target = RandomPoints(
            kind="random_points", count=5, half_size_m=1.5, inertia_ratios=[-0.186, -0.0797]
        )
        orbit = KeplerOrbit(kind="kepler", semi_major_axis_km=7170.0, eccentricity=0.05)
        motion = SeenFromLeader(
            kind="seen_from_leader",
            position_m=[10.0, 60.0, 10.0],
            velocity_m_s=[0.01, -0.0225, -0.01],
            q_lt=[0.0, 0.0, 0.0, 1.0],
            rate_deg_s=rate,
            torque_deg_s2=list(torque),
        )
        for part in (target, orbit, motion, *parts):
            data |= part.simulate(data, clock, draws)
        return data

    return run
