"""The pinhole camera against rays in space, differences, and points behind it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.sensors import pinhole

SCALE, HALF = 335.0, np.array([240.0, 180.0])


def points(seed: int, count: int = 5) -> np.ndarray:
    return np.random.default_rng(seed).uniform([-9.0, -9.0, 2.0], [9.0, 9.0, 30.0], (count, 3))


@given(st.integers(0, 10**6))
def test_the_ray_through_the_pixel_meets_the_point(seed: int) -> None:
    point = points(seed)
    ray = np.concatenate([pinhole.project(point, SCALE), np.full((5, 1), SCALE)], axis=-1)
    assert np.linalg.norm(np.cross(ray, point), axis=-1) == pytest.approx(0.0, abs=1e-10)


@given(st.integers(0, 10**6))
def test_the_derivative_matches_differences(seed: int) -> None:
    point, step = points(seed), 1e-4
    differenced = [
        (pinhole.project(point + step * e, SCALE) - pinhole.project(point - step * e, SCALE))
        / (2 * step)
        for e in np.eye(3)
    ]
    expected = np.stack(differenced, axis=-1)
    error = pinhole.derivative(point, SCALE) - expected
    assert np.abs(error).max() < 1e-6 * np.abs(expected).max()


def test_scales_of_several_runs_broadcast() -> None:
    scale, point = np.array([[300.0], [400.0]]), points(1)
    for function in (pinhole.project, pinhole.derivative):
        both = function(point, scale)
        np.testing.assert_array_equal(both[1], function(point, 400.0))
        assert both.shape[0] == 2


def test_a_point_behind_the_camera_has_a_pixel_but_is_not_in_view() -> None:
    point = np.array([[1.0, 2.0, 10.0], [1.0, 2.0, -10.0], [1.0, 2.0, 0.0], [np.nan] * 3])
    pixel = pinhole.project(point, SCALE)
    np.testing.assert_allclose(pixel[1], [-33.5, -67.0])
    assert np.isnan(pixel[2:]).all()
    assert np.isnan(pinhole.derivative(point, SCALE)[2]).any()
    assert pinhole.in_view(point, pixel, HALF).tolist() == [True, False, False, False]


def test_the_image_ends_at_its_half_size_in_both_axes() -> None:
    pixel = np.array([[240.0, 180.0], [240.1, 0.0], [0.0, -180.1], [-240.0, 0.0]])
    point = np.concatenate([pixel / SCALE, np.ones((4, 1))], axis=-1)
    assert pinhole.in_view(point, pixel, HALF).tolist() == [True, False, False, True]


def test_the_camera_looks_along_the_bodys_negative_y() -> None:
    camera_axes_b = pinhole.BODY_TO_CAMERA
    np.testing.assert_array_equal(camera_axes_b[2], [0.0, -1.0, 0.0])
    assert np.linalg.det(camera_axes_b) == pytest.approx(1.0)
