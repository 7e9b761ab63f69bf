"""Points that are measured worse along one axis, as a stereo pair does along the line of sight."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.batch.estimate import estimate_from_points
from debrisest.batch.motion import Status
from debrisest.batch.tracks import tracks
from debrisest.dynamics.torque_free import torque_free

SIGMA = np.array([0.002, 0.002, 0.02])


def test_noise_that_is_the_same_along_all_axes_counts_in_full() -> None:
    points = np.zeros((2, 3, 3))
    one, three = tracks(np.arange(2.0), points, 0.1), tracks(np.arange(2.0), points, 0.1 + points)
    for each in zip(one, three):
        np.testing.assert_array_equal(*each)
    assert (one.even == 1.0).all()


def test_the_worst_axis_is_the_weight_and_the_others_count_for_less() -> None:
    points = np.zeros((2, 3, 3))
    points[1, 2] = np.nan
    found = tracks(np.arange(2.0), points, np.broadcast_to(SIGMA, points.shape))
    np.testing.assert_allclose(found.weight[0], 1.0 / 0.02**2)
    np.testing.assert_allclose(found.even, (SIGMA**2).mean() / 0.02**2)
    assert found.weight[1, 2] == 0.0


@pytest.mark.parametrize("seed", range(3))
def test_a_stereo_pair_s_points_are_accepted_with_errors_as_told(seed: int) -> None:
    draws, times = np.random.default_rng(seed), np.arange(60.0)
    body = draws.uniform(-1.0, 1.0, (20, 3)) * [3.0, 1.0, 1.0]
    q, rate = torque_free(
        times, np.array([1.0, 0, 0, 0]), np.radians([3.0, 5.0, 2.0]), np.array([0.4, 0.9, 1.0])
    )
    exact = quaternion.rotate(q[:, None], body) + np.array([0.0, 0.0, 20.0])
    seen = exact + SIGMA * draws.normal(size=exact.shape)
    found = estimate_from_points(times, seen, np.broadcast_to(SIGMA, seen.shape))
    assert found.status in (Status.ACCEPTED, Status.ACCEPTED_IN_PART)
    assert found.fit is not None and found.arc is not None
    assert abs(found.fit.excess - 1.0) < 5.0 * np.sqrt(2.0 / found.fit.dof)
    speed = np.linalg.norm(found.arc.rate)
    true = np.linalg.norm(rate[np.argmin(np.abs(times - found.arc.epoch))])
    assert abs(speed - true) < np.radians(0.02)
