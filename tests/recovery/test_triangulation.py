"""Points from two cameras: exact without noise, and as uncertain as they say."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.recovery.triangulation import triangulate

ROTATION = np.stack([np.eye(3), Rotation.from_euler("y", 4.0, degrees=True).as_matrix()])
SHIFT = np.array([[0.0, 0.0, 0.0], [-0.8, 0.02, 0.01]])


def seen(points, rotation=ROTATION, shift=SHIFT):
    """Slopes (..., camera, feature, 2) of points (..., feature, 3)."""
    local = [points @ turn.T + move for turn, move in zip(rotation, shift)]
    return np.stack([each[..., :2] / each[..., 2:] for each in local], axis=-3)


@pytest.fixture
def points():
    return np.random.default_rng(2).normal(size=(2, 60, 6, 3)) + np.array([0.0, 0.0, 9.0])


def test_slopes_without_noise_give_the_points(points) -> None:
    found = triangulate(ROTATION, SHIFT, seen(points))
    np.testing.assert_allclose(found.point, points, rtol=0, atol=1e-10)
    assert found.chi2.max() < 1e-20


def test_a_point_that_one_camera_sees_has_no_place(points) -> None:
    slopes = seen(points)
    slopes[0, 3, 1, 2] = np.nan
    slopes[1, 5] = np.nan
    found = triangulate(ROTATION, SHIFT, slopes)
    missing = np.isnan(found.point[..., 0])
    assert missing[0, 3, 2] and missing[1, 5].all() and missing.sum() == 7
    assert np.array_equal(missing, np.isnan(found.cofactor[..., 0, 0]))


def test_lines_that_do_not_meet_ahead_have_no_place() -> None:
    away, parallel = [[[-0.3, 0.0]], [[0.3, 0.0]]], [[[0.1, 0.0]], [[0.1, 0.0]]]
    for slopes in (away, parallel):
        found = triangulate(np.stack([np.eye(3)] * 2), SHIFT * [1, 0, 0], np.array(slopes))
        assert np.isnan(found.point).all()


@pytest.mark.parametrize("scale, fits", [(1.0, True), (2.0, False)])
def test_covariance_is_that_of_the_errors(points, scale, fits) -> None:
    """Mean normalised square of 720 errors to five sigma, near 3; with half the noise told, not."""
    slopes = seen(points)
    noise = 1e-3
    slopes += scale * noise * np.random.default_rng(3).standard_normal(slopes.shape)
    found = triangulate(ROTATION, SHIFT, slopes)
    error = (found.point - points)[..., None]
    nees = np.sum(error * np.linalg.solve(noise**2 * found.cofactor, error), axis=(-2, -1))
    assert (abs(nees.mean() - 3.0) < 5 * np.sqrt(6.0 / nees.size)) == fits
    share = found.chi2.sum() / found.dof.sum() / noise**2
    assert (abs(share - 1.0) < 5 * np.sqrt(2.0 / found.dof.sum())) == fits
