"""A camera that looks at its target: axes by geometry, rate by differences."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics.pointing import camera_axes, camera_rate

N = 1.078e-3
COORDINATE = st.floats(-50, 50)
POSITIONS = st.tuples(st.floats(1, 50), st.floats(0, 2 * np.pi), st.floats(-1.4, 1.4)).map(
    lambda p: (
        p[0] * np.array([np.cos(p[1]) * np.cos(p[2]), np.sin(p[1]) * np.cos(p[2]), np.sin(p[2])])
    )
)
VELOCITIES = st.tuples(*[st.floats(-0.05, 0.05)] * 3).map(np.array)


@given(POSITIONS)
def test_the_optical_axis_points_at_the_target_and_x_stays_in_the_plane(position: Array) -> None:
    axes = camera_axes(position)
    assert np.allclose(axes[:, 2], -position / np.linalg.norm(position), atol=1e-12)
    assert np.allclose(axes.T @ axes, np.eye(3), atol=1e-12)
    assert np.isclose(np.linalg.det(axes), 1.0)
    assert axes[2, 0] == 0.0
    assert axes[2, 1] < 0.0


@given(POSITIONS, VELOCITIES)
def test_the_rate_is_that_of_the_axes(position: Array, velocity: Array) -> None:
    half = 1e-3

    def inertial(time: float) -> Array:
        turn = quaternion.to_matrix(quaternion.exp(np.array([0.0, 0.0, N * time])))
        return turn @ camera_axes(position + time * velocity)

    spin = inertial(0.0).T @ (inertial(half) - inertial(-half)) / (2 * half)
    found = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    assert np.allclose(camera_rate(position, velocity, N), found, atol=1e-8)


def test_batches_broadcast() -> None:
    positions = np.array([[5.0, 17.0, 6.0], [-3.0, 2.0, 1.0]])
    for one, both in zip(positions, camera_axes(positions)):
        assert np.array_equal(camera_axes(one), both)
    assert camera_rate(positions, 0.01 * positions[::-1], N).shape == (2, 3)


def _first(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])


def _third(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def test_a_3_1_sequence_never_points_its_first_axis_out_of_the_orbit() -> None:
    """Only the second or third can be the optical axis."""
    angles = np.random.default_rng(0).uniform(-np.pi, np.pi, (50, 2))
    for alpha, beta in angles:
        assert abs((_first(beta) @ _third(alpha))[0, 2]) < 1e-15
    position = np.array([5.0, 17.3205081, 5.90884652])
    azimuth = np.arctan2(position[1], position[0])
    elevation = np.arcsin(position[2] / np.linalg.norm(position))
    to_camera = _first(-np.pi / 2 - elevation) @ _third(azimuth + np.pi / 2)
    assert np.allclose(to_camera[2], -position / np.linalg.norm(position))
    assert np.allclose(to_camera, camera_axes(position).T)
