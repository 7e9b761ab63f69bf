"""The nearest rotation against random other ones."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from debrisest.attitude.rotation import nearest_rotation

seeds = st.integers(0, 2**32 - 1)


@given(seeds, st.sampled_from([-1.0, 1.0]))
def test_no_other_rotation_is_nearer(seed: int, side: float) -> None:
    """Of matrices of either determinant."""
    rng = np.random.default_rng(seed)
    matrix = rng.normal(size=(4, 3, 3))
    matrix[..., 0] *= side * np.sign(np.linalg.det(matrix))[:, None]
    rotation, scale = nearest_rotation(matrix)
    assert np.linalg.det(rotation) == pytest.approx(np.ones(4))
    np.testing.assert_allclose(rotation @ np.swapaxes(rotation, -1, -2) - np.eye(3), 0, atol=1e-12)
    np.testing.assert_allclose(scale, np.linalg.svd(matrix).S)
    for size in (1e-3, 0.1, 3.0):
        others = rotation @ Rotation.from_rotvec(
            size * rng.normal(size=(50, 1, 3)).reshape(-1, 3)
        ).as_matrix().reshape(50, 1, 3, 3)
        distance = np.linalg.norm(others - matrix, axis=(-2, -1))
        assert (distance >= np.linalg.norm(rotation - matrix, axis=(-2, -1)) - 1e-9).all()


@given(seeds)
def test_a_rotation_is_its_own_nearest(seed: int) -> None:
    rotation = Rotation.random(5, rng=np.random.default_rng(seed)).as_matrix()
    np.testing.assert_allclose(nearest_rotation(2.0 * rotation)[0], rotation, atol=1e-12)
