"""What the stereo pose problem doubts, against differences of integrated motions."""

import numpy as np
import pytest

from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.relative_orbit import leader_orbit
from debrisest.dynamics.relative_rotation import rotate, rotation_step
from debrisest.filters.replay.self_tests import self_tests
from debrisest.problems.stereo_pose import model as stereo_pose
from debrisest.problems.stereo_pose.doubts import doubts
from debrisest.problems.stereo_pose.model import RATE, K, Q

EPOCHS, PARTS = 15, 20


@pytest.fixture(scope="module")
def fast(experiment):
    return experiment(6, EPOCHS, 5)


def pushed(states, acceleration):
    """The motion with a constant angular acceleration (3,) in the target's axes, by small steps."""
    result = states.copy()
    rate, q = states[:, 0, RATE].copy(), states[:, 0, Q].copy()
    slopes, step = inertia_ratios.slopes(states[:, 0, K]), 1.0 / PARTS
    leader = leader_orbit(np.arange(2 * PARTS * (EPOCHS - 1) + 1) * step / 2, 7.17e6, 0.05, 0.0)
    for i in range(PARTS * (EPOCHS - 1)):
        moments = leader.at(2 * i), leader.at(2 * i + 1), leader.at(2 * i + 2)
        rate = rate + 0.5 * step * rotate(q, np.broadcast_to(acceleration, rate.shape))
        rate, q = rotation_step(rate, q, slopes, moments, step)
        rate = rate + 0.5 * step * rotate(q, np.broadcast_to(acceleration, rate.shape))
        if (i + 1) % PARTS == 0:
            result[:, (i + 1) // PARTS, RATE], result[:, (i + 1) // PARTS, Q] = rate, q
    return result


def shown(known, states):
    each = [stereo_pose.measurement(known, states[:, k], k) for k in range(EPOCHS)]
    return np.stack(each, axis=1)


def columns(test):
    states, turning = test.model.trajectory(test.truth[:, 0], 0, EPOCHS - 1)
    rows = test.model.rows(states, turning, 0, np.arange(EPOCHS))
    return [doubt.column(states, turning, *rows) for doubt in doubts(test.known)]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_torque_is_that_of_a_motion_with_one(fast, axis):
    small = 1e-6 * np.eye(3)[axis]
    ends = [shown(fast.known, pushed(fast.truth, sign * small)) for sign in (1, -1)]
    difference = (ends[0] - ends[1]) / 2e-6
    scale = np.abs(difference).max()
    np.testing.assert_allclose(columns(fast)[1 + axis], difference, atol=0.01 * scale)


def test_a_focal_length_scales_what_cameras_show(fast):
    np.testing.assert_allclose(columns(fast)[0], shown(fast.known, fast.truth), atol=1e-9)


def test_a_torque_is_told_and_none_is_not(fast):
    found = fast.estimate()
    known = fast.prior, fast.covariance
    assert not any(t.failed.any() for t in self_tests(fast.model, *known, fast.measured, found))
    push = np.array([0.0, 0.0, 3e-4])
    measured = fast.measured + shown(fast.known, pushed(fast.truth, push)) - fast.exact
    found = fast.estimate_of(measured)
    tests = self_tests(fast.model, *known, measured, found)
    assert tests[4].failed.all()
    np.testing.assert_allclose(np.median(tests[4].size), np.degrees(3e-4), rtol=0.2)
