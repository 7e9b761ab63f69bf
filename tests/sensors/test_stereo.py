"""Two cameras against rays in space, the differenced projection, and each other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.sensors import stereo

seeds = st.integers(0, 10**6)
BASELINE = 1.3


def moving_point(seed):
    rng = np.random.default_rng(seed)
    return rng.uniform([-20, 5, -20], [20, 80, 20]), rng.normal(size=3)


@given(seeds)
def test_a_point_lies_on_the_rays_of_both_cameras(seed):
    point, velocity = moving_point(seed)
    shown = stereo.measure(point, velocity, BASELINE)
    for camera, (u, v) in (((0, 0, 0), shown[:2]), ((BASELINE, 0, 0), shown[2:4])):
        ray = np.array([u, 1.0, v])
        assert np.linalg.norm(np.cross(point - camera, ray)) < 1e-12 * np.linalg.norm(point) * 10
    assert stereo.depth(shown, BASELINE) == pytest.approx(point[1], rel=1e-12)
    assert shown[8] == pytest.approx(shown[2] - shown[0], abs=1e-15)


@given(seeds)
def test_flow_is_the_derivative_of_the_projection(seed):
    point, velocity = moving_point(seed)
    step = 1e-3
    ahead, behind = (
        stereo.measure(point + s * step * velocity, velocity, BASELINE)[:4] for s in (1, -1)
    )
    flow = stereo.measure(point, velocity, BASELINE)[stereo.FLOW]
    np.testing.assert_allclose(flow, (ahead - behind) / (2 * step), atol=1e-7)


@given(seeds)
def test_jacobian_matches_differences(seed):
    point, velocity = moving_point(seed)
    both, step = np.concatenate([point, velocity]), 1e-5
    differenced = [
        (
            stereo.measure(*np.split(both + step * e, 2), BASELINE)
            - stereo.measure(*np.split(both - step * e, 2), BASELINE)
        )
        / (2 * step)
        for e in np.eye(6)
    ]
    np.testing.assert_allclose(
        stereo.jacobian(point, velocity, BASELINE), np.transpose(differenced), atol=1e-8
    )


def test_depth_uses_what_there_is():
    shown = stereo.measure(np.array([[2.0, 40.0, 1.0]] * 4), np.zeros((4, 3)), BASELINE)
    shown[1, 8] = np.nan
    shown[2, 2] = np.nan
    shown[3, [0, 8]] = np.nan
    np.testing.assert_allclose(stereo.depth(shown, BASELINE), [40.0, 40.0, 40.0, np.nan])
