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
