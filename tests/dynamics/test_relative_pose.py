"""Exact relative translation against inertial integration (rotation: see the steps' test)."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from debrisest.dynamics.kepler import MU_EARTH, state_from_elements
from debrisest.dynamics.relative_pose import exact_translation

OFFSET, DRIFT = np.array([10.0, 60.0, 10.0]), np.array([0.01, -0.0225, -0.01])


@pytest.mark.parametrize("anomaly", [0.0, 2.0])
def test_exact_translation(anomaly):
    leader = state_from_elements(7.17e6, 0.05, 0.26, 0.3, 5.9, anomaly)
    position, velocity = leader
    radial = position / np.linalg.norm(position)
    momentum = np.cross(position, velocity)
    normal = momentum / np.linalg.norm(momentum)
    axes = np.array([radial, np.cross(normal, radial), normal])
    rate = momentum / (position @ position)
    target = np.concatenate(
        [position + axes.T @ OFFSET, velocity + axes.T @ DRIFT + np.cross(rate, axes.T @ OFFSET)]
    )

    def derivative(_, state):
        return np.concatenate([state[3:], -MU_EARTH * state[:3] / np.linalg.norm(state[:3]) ** 3])

    ends = [
        solve_ivp(derivative, (0, 100), s, method="DOP853", rtol=1e-13, atol=1e-9).y[:, -1]
        for s in (np.concatenate(leader), target)
    ]
    radial = ends[0][:3] / np.linalg.norm(ends[0][:3])
    axes = np.array([radial, np.cross(normal, radial), normal])
    rate = momentum / (ends[0][:3] @ ends[0][:3])
    relative = ends[1] - ends[0]
    times = np.array([0.0, 100.0])
    found, closing = exact_translation(times, OFFSET, DRIFT, leader)
    np.testing.assert_allclose(found[0], OFFSET, atol=1e-8)
    np.testing.assert_allclose(closing[0], DRIFT, atol=1e-11)
    np.testing.assert_allclose(found[1], axes @ relative[:3], atol=1e-7)
    np.testing.assert_allclose(
        closing[1], axes @ (relative[3:] - np.cross(rate, relative[:3])), atol=1e-10
    )
