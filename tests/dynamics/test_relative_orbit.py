"""Relative motion in the leader's axes against inertial two-body integration."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from debrisest.dynamics.kepler import MU_EARTH
from debrisest.dynamics.relative_orbit import leader_orbit, transitions, translation_step

AXIS, ECCENTRICITY = 7.17e6, 0.05
POSITION, VELOCITY = np.array([10.0, 60.0, 10.0]), np.array([0.01, -0.0225, -0.01])


def inertial_start(anomaly):
    """Leader and target in inertial axes, written down from the orbit equation."""
    parameter = AXIS * (1 - ECCENTRICITY**2)
    radius = parameter / (1 + ECCENTRICITY * np.cos(anomaly))
    momentum = np.sqrt(MU_EARTH * parameter)
    climb = MU_EARTH / momentum * ECCENTRICITY * np.sin(anomaly)
    rate = momentum / radius**2
    axes = np.array(
        [[np.cos(anomaly), -np.sin(anomaly), 0], [np.sin(anomaly), np.cos(anomaly), 0], [0, 0, 1]]
    )
    leader = np.concatenate([axes @ [radius, 0, 0], axes @ [climb, radius * rate, 0]])
    seen = VELOCITY + np.cross([0, 0, rate], POSITION)
    return leader, leader + np.concatenate([axes @ POSITION, axes @ seen])


def integrate(start, seconds):
    def derivative(_, state):
        return np.concatenate([state[3:], -MU_EARTH * state[:3] / np.linalg.norm(state[:3]) ** 3])

    return solve_ivp(derivative, (0, seconds), start, method="DOP853", rtol=1e-13, atol=1e-9).y[
        :, -1
    ]


def relative_in_leader_axes(leader, target):
    radial = leader[:3] / np.linalg.norm(leader[:3])
    momentum = np.cross(leader[:3], leader[3:])
    normal = momentum / np.linalg.norm(momentum)
    axes = np.array([radial, np.cross(normal, radial), normal])
    rate = momentum / (leader[:3] @ leader[:3])
    relative = target - leader
    return axes @ relative[:3], axes @ (relative[3:] - np.cross(rate, relative[:3]))


def propagate(position, velocity, anomaly, epochs, step=1.0):
    times = np.arange(2 * epochs + 1) * 0.5 * step
    leader = leader_orbit(times, AXIS, ECCENTRICITY, anomaly)
    for k in range(0, 2 * epochs, 2):
        moments = leader.at(k), leader.at(k + 1), leader.at(k + 2)
        position, velocity = translation_step(position, velocity, moments, step)
    return position, velocity


@pytest.mark.parametrize("anomaly", [0.0, 1.1, 3.0, 5.5])
def test_matches_inertial_integration(anomaly):
    leader, target = (integrate(start, 100.0) for start in inertial_start(anomaly))
    expected_position, expected_velocity = relative_in_leader_axes(leader, target)
    position, velocity = propagate(POSITION, VELOCITY, anomaly, 100)
    np.testing.assert_allclose(position, expected_position, atol=1e-7)
    np.testing.assert_allclose(velocity, expected_velocity, atol=1e-10)


def test_the_leader_follows_kepler():
    """Rates against differences of the anomaly; equal areas; a turn takes a period."""
    period = 2 * np.pi * np.sqrt(AXIS**3 / MU_EARTH)
    times = np.linspace(0.0, period, 2001)
    leader = leader_orbit(times, AXIS, ECCENTRICITY, 0.4)
    assert leader.anomaly[-1] - leader.anomaly[0] == pytest.approx(2 * np.pi, abs=1e-9)
    step = times[1]
    differenced = (leader.anomaly[2:] - leader.anomaly[:-2]) / (2 * step)
    np.testing.assert_allclose(leader.rate[1:-1], differenced, rtol=1e-5)
    np.testing.assert_allclose(
        leader.acceleration[1:-1], (leader.rate[2:] - leader.rate[:-2]) / (2 * step), atol=1e-11
    )
    areas = leader.radius**2 * leader.rate
    np.testing.assert_allclose(areas, areas[0], rtol=1e-12)
    assert leader.radius.min() == pytest.approx(AXIS * (1 - ECCENTRICITY), rel=1e-6)


def test_a_step_back_undoes_a_step():
    leader = leader_orbit(np.array([0.0, 0.5, 1.0]), AXIS, ECCENTRICITY, 0.0)
    ahead = leader.at(0), leader.at(1), leader.at(2)
    there = translation_step(POSITION, VELOCITY, ahead, 1.0)
    position, velocity = translation_step(*there, ahead[::-1], -1.0)
    np.testing.assert_allclose(position, POSITION, atol=1e-12)
    np.testing.assert_allclose(velocity, VELOCITY, atol=1e-14)


def test_transitions_match_differences():
    """Also far from the leader, where the linearisation is made, within what is promised."""
    epochs = 100
    leader = leader_orbit(np.arange(2 * epochs + 1) * 0.5, AXIS, ECCENTRICITY, 0.0)
    matrix = transitions(leader, np.ones(len(leader.radius) // 2))[-1]
    for index in range(6):
        change = np.zeros(6)
        change[index] = 1.0
        ends = [
            np.concatenate(
                propagate(POSITION + s * change[:3], VELOCITY + s * change[3:], 0.0, epochs)
            )
            for s in (1, -1)
        ]
        np.testing.assert_allclose(matrix[:, index], 0.5 * (ends[0] - ends[1]), atol=2e-5)


def test_batches_give_the_same_as_single_targets():
    positions = POSITION + np.arange(6.0).reshape(2, 1, 3)
    velocities = np.broadcast_to(VELOCITY, positions.shape)
    batch, _ = propagate(positions, velocities, 0.3, 3)
    for i in range(2):
        single, _ = propagate(positions[i, 0], VELOCITY, 0.3, 3)
        np.testing.assert_array_equal(batch[i, 0], single)
