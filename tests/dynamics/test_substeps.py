"""Parts of time steps, and fast torque-free motion over long steps against the closed form."""

import numpy as np
import pytest

from debrisest.dynamics.integrators import rk4_step
from debrisest.dynamics.substeps import LARGEST_TURN, MOST, parts, substeps
from debrisest.dynamics.torque_free import torque_free


def test_every_part_turns_little_and_all_parts_make_the_step():
    speed = np.array([0.0, 0.05, -0.1, 0.31, 2.0, 1e9, np.inf, np.nan])
    count = substeps(speed, -2.0)
    np.testing.assert_array_equal(count, [1, 1, 2, 7, 40, MOST, MOST, 1])
    lengths = np.array([part for _, part in parts(-2.0, count)])
    np.testing.assert_allclose(lengths.sum(0), -2.0)
    assert np.abs(speed * lengths)[:, :5].max() < LARGEST_TURN + 1e-12


def test_where_nothing_is_fast_the_step_stays_one():
    assert list(parts(3.0, substeps(np.array([1e-3, 0.0]), 3.0))) == [(0, 3.0)]


@pytest.mark.parametrize("step", [1.0, 5.0])
def test_a_fast_body_is_followed_over_long_steps(step):
    moments = np.array([0.4, 0.7, 1.0])
    rate0, q0 = np.radians([8.0, 3.0, -5.0]), np.array([1.0, 0.0, 0.0, 0.0])
    ratio = (np.roll(moments, -1) - np.roll(moments, -2)) / moments
    q, rate = q0[:, None], rate0[:, None]
    for _ in range(20):
        q, rate = rk4_step(q, rate, ratio[:, None], step)
    exact_q, exact_rate = torque_free(np.array([20 * step]), q0, rate0, moments)
    np.testing.assert_allclose(rate[:, 0], exact_rate[0], atol=1e-6)
    assert abs(q[:, 0] / np.linalg.norm(q) @ exact_q[0]) > 1 - 1e-9
