"""Euler angles against scipy's Rotation."""

import hypothesis.extra.numpy as hnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array
from debrisest.attitude import euler


@given(hnp.arrays(float, 4, elements=st.floats(-1.0, 1.0)).filter(lambda q: q @ q > 1e-6))
def test_pitch_is_the_middle_angle_of_zyx(q: Array) -> None:
    q = q / np.linalg.norm(q)
    rotation = Rotation.from_quat(q, scalar_first=True)
    assert np.sin(euler.pitch(q)) == pytest.approx(-rotation.as_matrix()[2, 0], abs=1e-15)
    if abs(rotation.as_matrix()[2, 0]) < 0.999:
        assert euler.pitch(q) == pytest.approx(rotation.as_euler("ZYX")[1], abs=1e-12)


def test_pitch_at_the_poles_is_not_nan() -> None:
    up = np.array([1.0, 0.0, 1.0, 0.0]) * (np.sqrt(0.5) * (1 + 1e-15))
    down = np.array([1.0, 0.0, -1.0, 0.0]) * (np.sqrt(0.5) * (1 + 1e-15))
    pitches = euler.pitch(np.stack([up, -up, down]))
    np.testing.assert_allclose(pitches, np.pi / 2 * np.array([1, 1, -1]))


def test_unseen_attitude_has_no_pitch() -> None:
    q = np.array([[1.0, 0.0, 0.0, 0.0], [np.nan] * 4])
    np.testing.assert_array_equal(euler.pitch(q), [0.0, np.nan])


angles = hnp.arrays(float, 3, elements=st.floats(-1.3, 1.3))


@given(angles)
def test_angles_are_roll_pitch_yaw_of_the_body_in_the_reference(angle: Array) -> None:
    oracle = Rotation.from_euler("ZYX", angle[::-1])
    np.testing.assert_allclose(euler.to_matrix(angle), oracle.as_matrix(), atol=1e-14)
    np.testing.assert_allclose(euler.from_matrix(oracle.as_matrix()), angle, atol=1e-12)
    turned = Rotation.from_quat(euler.to_quaternion(angle), scalar_first=True)
    assert (turned.inv() * oracle).magnitude() < 1e-14
    assert euler.pitch(euler.to_quaternion(angle)) == pytest.approx(angle[1], abs=1e-12)


def turned_by(angle: Array, rate_b: Array, time: float) -> Array:
    """Angles after a turn with a constant body rate."""
    after = Rotation.from_euler("ZYX", angle[::-1]) * Rotation.from_rotvec(rate_b * time)
    return after.as_euler("ZYX")[::-1]


@given(angles, hnp.arrays(float, 3, elements=st.floats(-1.0, 1.0)))
def test_rates_of_the_angles_and_their_change_match_differences(angle: Array, rate: Array) -> None:
    step = 1e-4
    before, after = turned_by(angle, rate, -step), turned_by(angle, rate, step)
    rates = euler.rates(angle, rate)
    np.testing.assert_allclose(rates, (after - before) / (2 * step), atol=1e-5)
    np.testing.assert_allclose(euler.body_rate(angle, rates), rate, atol=1e-12)
    ahead, behind = (euler.rates(turned_by(angle, rate, s * step), rate) for s in (1, -1))
    change = (ahead - behind) / (2 * step)
    np.testing.assert_allclose(euler.rates_change(angle, rate), change, atol=1e-4)
