"""Poses from pixels: exact without noise, and as uncertain as they say."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.batch.pixel_pose import Camera, poses_from_pixels

FOCAL, CENTRE = np.array([800.0, 820.0]), np.array([320.0, 240.0])
LEFT = Camera(FOCAL, CENTRE, np.zeros(3), np.eye(3))
TOED_IN = Rotation.from_euler("y", -4.0, degrees=True).as_matrix()
RIGHT = Camera(FOCAL, CENTRE, np.array([0.8, 0.0, 0.0]), TOED_IN)


def scene(count, seed):
    rng = np.random.default_rng(seed)
    attitude = Rotation.random(count, rng=rng)
    position = np.array([0.3, -0.2, 9.0]) + rng.normal(size=(count, 3))
    return rng, attitude, position


def shown(camera, placed):
    local = (placed - camera.position) @ camera.axes
    return camera.centre + camera.focal * local[..., :2] / local[..., 2:]


def pixels_of(cameras, attitude, position, model):
    placed = np.einsum("kij,cj->kci", attitude.as_matrix(), model) + position[:, None]
    return np.stack([shown(camera, placed) for camera in cameras], axis=1)


@pytest.mark.parametrize("cameras", [[LEFT], [LEFT, RIGHT]], ids=["one", "two"])
def test_pixels_without_noise_give_the_pose(cameras, box) -> None:
    _, attitude, position = scene(40, 0)
    pixels = pixels_of(cameras, attitude, position, box)
    poses = poses_from_pixels(cameras, pixels, 0.5, box)
    turn = Rotation.from_quat(poses.q, scalar_first=True) * attitude.inv()
    assert turn.magnitude().max() < 1e-6
    assert np.abs(poses.position - position).max() < 1e-5
    assert poses.chi2.max() < 1e-6


def test_covariance_is_that_of_the_errors(box) -> None:
    """Mean normalised square of the six errors over 300 epochs, to five sigma."""
    cameras = [LEFT, RIGHT]
    rng, attitude, position = scene(300, 1)
    pixels = pixels_of(cameras, attitude, position, box)
    pixels += 0.5 * rng.normal(size=pixels.shape)
    pixels[rng.uniform(size=pixels.shape[:3]) < 0.2] = np.nan
    poses = poses_from_pixels(cameras, pixels, 0.5, box)
    turn = (Rotation.from_quat(poses.q, scalar_first=True) * attitude.inv()).as_rotvec()
    error = np.hstack([turn, poses.position - position])
    known = np.isfinite(turn[:, 0])
    assert known.sum() >= 295
    solved = np.linalg.solve(poses.covariance[known], error[known, :, None])[..., 0]
    mean = np.mean(np.sum(solved * error[known], axis=-1))
    assert abs(mean - 6.0) < 5.0 * np.sqrt(12.0 / known.sum())
    assert abs(np.sum(poses.chi2) / np.sum(poses.dof) - 1.0) < 5 * np.sqrt(2 / np.sum(poses.dof))


def test_two_points_give_no_pose(box) -> None:
    _, attitude, position = scene(3, 2)
    pixels = pixels_of([LEFT, RIGHT], attitude, position, box)
    pixels[1, :, 2:] = np.nan
    poses = poses_from_pixels([LEFT, RIGHT], pixels, 0.5, box)
    assert np.isnan(poses.q[1]).all()
    assert np.isfinite(poses.q[[0, 2]]).all()
