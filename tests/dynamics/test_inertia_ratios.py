"""Inertia ratios against moments, Euler's equations and the triangle inequalities."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from debrisest.dynamics import inertia_ratios

moment = st.floats(0.05, 20.0)
seeds = st.integers(0, 10**6)


def physical_moments(seed):
    """Second moments of a mass distribution are positive; their sums are moments of inertia."""
    second = np.random.default_rng(seed).exponential(size=3) + 0.05
    return second.sum() - second


@given(st.tuples(moment, moment, moment))
def test_ratios_and_moments(moments):
    moments = np.array(moments)
    k = inertia_ratios.ratios(moments)
    np.testing.assert_allclose(k, np.log([moments[0] / moments[1], moments[1] / moments[2]]))
    np.testing.assert_allclose(inertia_ratios.moments(k), moments / moments[1], rtol=1e-12)


@given(seeds)
def test_euler_equations(seed):
    moments, rate = physical_moments(seed), np.random.default_rng(seed).normal(size=3)
    expected = -np.cross(rate, moments * rate) / moments
    k = inertia_ratios.ratios(moments)
    np.testing.assert_allclose(inertia_ratios.angular_acceleration(rate, k), expected, atol=1e-12)


@given(seeds)
def test_derivatives_match_differences(seed):
    rng = np.random.default_rng(seed)
    rate, k, step = rng.normal(size=3), rng.uniform(-1, 1, 2), 1e-6
    acceleration = inertia_ratios.angular_acceleration
    by_rate = [
        (acceleration(rate + step * e, k) - acceleration(rate - step * e, k)) / (2 * step)
        for e in np.eye(3)
    ]
    by_k = [
        (acceleration(rate, k + step * e) - acceleration(rate, k - step * e)) / (2 * step)
        for e in np.eye(2)
    ]
    np.testing.assert_allclose(
        inertia_ratios.acceleration_by_rate(rate, k), np.transpose(by_rate), atol=1e-7
    )
    np.testing.assert_allclose(
        inertia_ratios.acceleration_by_ratios(rate, k), np.transpose(by_k), atol=1e-7
    )


@given(seeds)
def test_triangle_inequalities_bound_the_slopes(seed):
    k = inertia_ratios.ratios(physical_moments(seed))
    slopes = inertia_ratios.slopes(k)
    assert np.all(np.abs(slopes) < 1)
    np.testing.assert_allclose(inertia_ratios.from_slopes(slopes[[0, 2]]), k, atol=1e-10)
    sx, sy, sz = slopes
    np.testing.assert_allclose(sy, -(sx + sz) / (1 + sx * sz), atol=1e-12)


@given(st.tuples(moment, moment, moment))
def test_impossible_bodies_have_a_slope_beyond_one(moments):
    broken = 2 * max(moments) > sum(moments) * (1 + 1e-9)
    slopes = inertia_ratios.slopes(inertia_ratios.ratios(np.array(moments)))
    assert broken <= bool(np.abs(slopes).max() > 1)


@given(seeds)
def test_move_is_a_physical_first_order_step(seed):
    rng = np.random.default_rng(seed)
    k = inertia_ratios.feasible(rng.normal(size=2))
    direction, step = rng.normal(size=2), 1e-6
    moved = inertia_ratios.move(k, step * direction)
    np.testing.assert_allclose((moved - k) / step, direction, atol=1e-3)
    np.testing.assert_allclose(inertia_ratios.move(k, np.zeros(2)), k, atol=1e-12)
    far = inertia_ratios.move(k, 1e3 * direction)
    assert np.all(np.abs(inertia_ratios.slopes(far)) < 1)


def test_feasible_leaves_physical_ratios_alone_and_mends_the_others():
    k = np.array([[0.1, -0.2], [5.0, 5.0], [-3.0, 1.0], [np.nan, 0.0]])
    mended = inertia_ratios.feasible(k)
    np.testing.assert_array_equal(mended[0], k[0])
    assert np.all(np.abs(inertia_ratios.slopes(mended[1:3])) < 0.95)
    np.testing.assert_allclose(np.sign(mended[1:3]), np.sign(k[1:3]))
    assert np.isnan(mended[3, 0])
