"""What a leader sees of a target's motion."""

from collections.abc import Callable

import numpy as np
import pytest

from debrisest.attitude import quaternion

STEP = 0.01


@pytest.fixture(scope="module")
def fine(simulated: Callable) -> dict:
    return simulated(runs=2, duration=1.0, step=STEP, rate=[-1.0, -1.0, 0.934])


def test_it_starts_as_told(fine: dict) -> None:
    assert fine["true_position"][:, 0] == pytest.approx(np.tile([10, 60, 10], (2, 1)), abs=1e-7)
    assert fine["true_rate_l"][0, 0] == pytest.approx(np.radians([-1, -1, 0.934]), abs=1e-12)
    assert np.abs(fine["true_q_lt"][0, 0]) == pytest.approx([0, 0, 0, 1], abs=1e-12)


def test_velocity_is_the_derivative_of_position(fine: dict) -> None:
    slope = np.gradient(fine["true_position"], STEP, axis=1)[:, 1:-1]
    assert slope == pytest.approx(fine["true_velocity"][:, 1:-1], abs=1e-6)


def test_the_rate_turns_the_attitude(fine: dict) -> None:
    """Body vectors turn about the leader's axes with the relative rate: a_dot = w x a."""
    for axis in np.eye(3):
        seen = quaternion.rotate(fine["true_q_lt"], axis)
        slope = np.gradient(seen, STEP, axis=1)[:, 1:-1]
        turned = np.cross(fine["true_rate_l"], seen)[:, 1:-1]
        assert slope == pytest.approx(turned, abs=1e-7)


def test_initial_rates_are_round_about_the_body(simulated: Callable) -> None:
    """At the perigee the orbit turns by 0.0659 deg/s, which the paper's rates leave out."""
    data = simulated(runs=1)
    rate = data["true_rate_l"][0, 0] + np.radians([0, 0, 0.065936])
    body = quaternion.rotate(quaternion.conjugate(data["true_q_lt"][0, 0]), rate)
    assert np.degrees(body) == pytest.approx([0.1, 0.1, 0.1], abs=1e-4)


def test_a_torque_changes_the_angular_momentum_as_it_should(simulated: Callable) -> None:
    """In inertial axes, those of the leader at first: dH/dt = torque, by differences in time."""
    torque = np.radians([2e-3, -1e-3, 3e-3])
    data = simulated(runs=2, duration=4.0, step=STEP, torque=np.degrees(torque).tolist())
    anomaly = np.arctan2(*data["orbit_position"][0, :, [1, 0]])
    turn = np.gradient(anomaly, STEP)[:, None] * [0.0, 0.0, 1.0]
    half, zero = 0.5 * (anomaly - anomaly[0]), 0.0 * anomaly
    q_it = quaternion.multiply(
        np.stack([np.cos(half), zero, zero, np.sin(half)], -1), data["true_q_lt"]
    )
    moments = data["true_inertia_b"][0].diagonal()
    back = quaternion.conjugate(data["true_q_lt"])
    momentum = moments * quaternion.rotate(back, data["true_rate_l"] + turn)
    slope = np.gradient(quaternion.rotate(q_it, momentum), STEP, axis=1)[:, 2:-2]
    expected = quaternion.rotate(q_it, np.broadcast_to(moments * torque, momentum.shape))
    assert slope == pytest.approx(expected[:, 2:-2], abs=1e-3 * np.abs(torque).max())
