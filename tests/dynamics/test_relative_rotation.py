"""Relative rotation against the rotation matrix, integration of Euler's equations, and limits."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from debrisest.attitude.vectors import cross, matrix_of_cross
from debrisest.dynamics.inertia_ratios import ratios, slopes
from debrisest.dynamics.relative_orbit import leader_orbit
from debrisest.dynamics.relative_pose import exact_rotation
from debrisest.dynamics.relative_rotation import (
    rotate,
    rotation_by_quaternion,
    rotation_matrix,
    rotation_step,
    unrotate,
)

AXIS, ECCENTRICITY = 7.17e6, 0.05


def draw(seed, *shape):
    return np.random.default_rng(seed).normal(size=shape)


@given(st.integers(0, 10**6), st.floats(0.1, 10.0))
def test_rotation_of_a_quaternion_of_any_norm(seed, norm):
    q, v = draw(seed, 4), draw(seed + 1, 3)
    turn = Rotation.from_quat(q, scalar_first=True)
    scaled = norm * q / np.linalg.norm(q)
    np.testing.assert_allclose(rotate(scaled, v), turn.apply(v), atol=1e-13)
    np.testing.assert_allclose(unrotate(scaled, v), turn.inv().apply(v), atol=1e-13)
    np.testing.assert_allclose(rotate(scaled, v, raw=True), norm**2 * turn.apply(v), atol=1e-10)
    np.testing.assert_allclose(rotation_matrix(scaled), turn.as_matrix(), atol=1e-13)


@given(st.integers(0, 10**6), st.booleans())
def test_derivative_by_the_quaternion(seed, raw):
    q, v, step = draw(seed, 4) + 0.5, draw(seed + 1, 3), 1e-6
    differenced = [
        (rotate(q + step * e, v, raw) - rotate(q - step * e, v, raw)) / (2 * step)
        for e in np.eye(4)
    ]
    scale = 1.0 + 1.0 / (q @ q)
    np.testing.assert_allclose(
        rotation_by_quaternion(q, v, raw), np.transpose(differenced), atol=1e-8 * scale**3
    )


def test_cross():
    a, b = draw(0, 5, 3), draw(1, 5, 3)
    np.testing.assert_allclose(cross(a, b), np.cross(a, b), atol=1e-15)
    np.testing.assert_allclose((matrix_of_cross(a) @ b[..., None])[..., 0], np.cross(a, b))


def inertial(q_lt, rate_l, moments, seconds, leader):
    """Attitude and rate relative to the leader, by integration in inertial axes."""

    def derivative(_, state):
        q, rate = state[:4], state[4:]
        spin = np.array(
            [
                -q[1:] @ rate,
                q[0] * rate[0] + q[2] * rate[2] - q[3] * rate[1],
                q[0] * rate[1] + q[3] * rate[0] - q[1] * rate[2],
                q[0] * rate[2] + q[1] * rate[1] - q[2] * rate[0],
            ]
        )
        return np.concatenate([0.5 * spin, -np.cross(rate, moments * rate) / moments])

    to_l = Rotation.from_quat(q_lt, scalar_first=True)
    rate_t = to_l.inv().apply(rate_l + np.array([0, 0, leader.rate[0]]))
    end = solve_ivp(
        derivative,
        (0, seconds),
        np.concatenate([q_lt, rate_t]),
        method="DOP853",
        rtol=1e-12,
        atol=1e-14,
    ).y[:, -1]
    turned = Rotation.from_euler("z", -(leader.anomaly[-1] - leader.anomaly[0]))
    to_l = turned * Rotation.from_quat(end[:4], scalar_first=True)
    return to_l, to_l.apply(end[4:]) - [0, 0, leader.rate[-1]]


@settings(max_examples=25)
@given(st.integers(0, 10**6))
def test_steps_and_closed_form_match_inertial_integration(seed):
    rng = np.random.default_rng(seed)
    moments = rng.uniform(0.6, 1.0, 3)
    q, rate = rng.normal(size=4), np.radians(rng.uniform(-2.0, 2.0, 3))
    q /= np.linalg.norm(q)
    seconds = 20
    leader = leader_orbit(np.arange(2 * seconds + 1) * 0.5, AXIS, ECCENTRICITY, rng.uniform(0, 6))
    expected, expected_rate = inertial(q, rate, moments, seconds, leader)
    exact_q, exact_rate = exact_rotation(
        np.arange(seconds + 1.0), q, rate, ratios(moments), leader.at(slice(None, None, 2))
    )
    slope = slopes(ratios(moments))
    stepped, stepped_rate = q, rate
    for index in range(0, 2 * seconds, 2):
        moments_of_step = leader.at(index), leader.at(index + 1), leader.at(index + 2)
        stepped_rate, stepped = rotation_step(stepped_rate, stepped, slope, moments_of_step, 1.0)
    for attitude, angle in ((exact_q[-1], 1e-9), (stepped, 1e-6)):
        error = Rotation.from_quat(attitude, scalar_first=True) * expected.inv()
        assert error.magnitude() < angle
    np.testing.assert_allclose(exact_rate[-1], expected_rate, atol=1e-11)
    np.testing.assert_allclose(stepped_rate, expected_rate, atol=1e-7)


@pytest.mark.parametrize("back", [False, True])
def test_a_fast_target_is_followed_over_long_steps(back):
    """At 20 deg/s, 5 s to a step: one Runge-Kutta step would be off by a degree each time."""
    step, moments = -5.0 if back else 5.0, np.array([0.83, 1.0, 1.083])
    times = np.linspace(0.0, 10 * step, 21)
    leader = leader_orbit(times + 100.0, AXIS, ECCENTRICITY, 0.3)
    k = ratios(moments)
    q = np.array([[0.5, 0.5, 0.5, 0.5], [0.0, 0.0, 0.6, 0.8]])
    rate = np.radians([[12.0, -12.0, 10.0], [0.1, -0.1, 0.2]])
    exact_q, exact_rate = exact_rotation(times, q, rate, np.tile(k, (2, 1)), leader)
    alone_q, alone_rate = q[1:], rate[1:]
    for i in range(10):
        moments_of_step = leader.at(2 * i), leader.at(2 * i + 1), leader.at(2 * i + 2)
        rate, q = rotation_step(rate, q, slopes(k), moments_of_step, step)
        alone_rate, alone_q = rotation_step(alone_rate, alone_q, slopes(k), moments_of_step, step)
    np.testing.assert_allclose(rate, exact_rate[:, -1], atol=2e-6)
    unit = q / np.linalg.norm(q, axis=-1, keepdims=True)
    assert np.abs(np.sum(unit * exact_q[:, -1], axis=-1)).min() > 1 - 1e-9
    np.testing.assert_array_equal(q[1:], alone_q)
    np.testing.assert_array_equal(rate[1:], alone_rate)
