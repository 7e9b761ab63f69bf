"""Back-face visibility against the geometry of a convex body."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from debrisest.target.visibility import back_face_visible

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


@given(st.integers(0, 2**32 - 1), st.floats(1.01, 100.0))
def test_a_sphere_shows_its_cap(seed, distance) -> None:
    """From the distance d a unit sphere shows the points with ``cos(angle) > 1/d``."""
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(50, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    turn = Rotation.random(rng=rng)
    direction = np.array([0.0, 0.6, -0.8])
    q_ib = turn.as_quat(scalar_first=True)
    cosine = turn.apply(normals) @ direction
    clear = np.abs(cosine - 1.0 / distance) > 1e-12
    visible = back_face_visible(normals, normals, q_ib, distance * direction)
    np.testing.assert_array_equal(visible[clear], (cosine > 1.0 / distance)[clear])


def test_a_near_observer_does_not_see_the_cap_of_a_long_body() -> None:
    points, normals = np.array([[0.0, 0.0, 6.0]]), np.array([[0.0, 0.0, 1.0]])
    direction = np.array([0.98, 0.0, 0.2])
    for distance, seen in ((29.0, False), (31.0, True)):
        assert back_face_visible(points, normals, IDENTITY, distance * direction) == seen


def test_batches_and_unknown_attitude() -> None:
    points, normals = np.eye(3), np.eye(3)
    q_ib = np.stack([IDENTITY, [0.0, 1.0, 0.0, 0.0], np.full(4, np.nan)])
    observer = np.array([[3.0, 3.0, 0.0], [3.0, 3.0, 0.0], [3.0, 3.0, 3.0]])
    visible = back_face_visible(points, normals, q_ib, observer)
    expected = [[True, True, False], [True, False, False], [False, False, False]]
    np.testing.assert_array_equal(visible, expected)
    assert back_face_visible(points, normals, q_ib[:, None], observer).shape == (3, 3, 3)
    moving_points = np.stack([points, 5.0 * points, points])
    moved = back_face_visible(moving_points, normals, q_ib, observer)
    np.testing.assert_array_equal(moved, [[True, True, False], [False] * 3, [False] * 3])
