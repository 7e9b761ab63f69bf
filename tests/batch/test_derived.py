"""Quantities that people ask for, against integration and textbook formulas."""

import numpy as np
from scipy.spatial.transform import Rotation

from debrisest.batch.derived import derived
from debrisest.batch.estimate import estimate_from_attitudes


def measured(truth, seed, sigma=0.01):
    rng = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(sigma * rng.normal(size=(len(truth.times), 3)))
    q = (turns * truth.attitude).as_quat(scalar_first=True)
    return estimate_from_attitudes(truth.times, q, sigma)


def test_general_body(tumbling) -> None:
    motion = measured(tumbling, 0)
    found = derived(motion.arc, motion.claimed)
    moments, axes = np.linalg.eigh(tumbling.inertia)
    assert np.all(np.abs(found.moments.value - moments / moments[-1]) <= 5 * found.moments.sigma)
    angle = np.arccos(np.minimum(np.abs(np.sum(axes * found.axes.value, axis=0)), 1.0))
    assert np.all(angle < 5.0 * found.axes.sigma)
    momentum = tumbling.attitude[0].apply(tumbling.inertia @ tumbling.rate[0])
    off = np.linalg.norm(np.cross(momentum / np.linalg.norm(momentum), found.momentum.value))
    assert off < 5.0 * np.linalg.norm(found.momentum.sigma)


def test_axisymmetric_body_has_a_symmetry_axis_and_a_period_only(body_of) -> None:
    """Nutation period in the body: 2 pi / (w_s |J_s/J_t - 1|)."""
    truth = body_of(np.arange(0.0, 400.0), [3.0, 0.0, 4.0], [1.0, 1.0, 0.6])
    motion = measured(truth, 1)
    found = derived(motion.arc, motion.claimed)
    assert np.isfinite(found.axes.value[:, 0]).all()
    assert np.isnan(found.axes.value[:, 1:]).all()
    assert np.isnan(found.axis_rates.value[1:]).all()
    spin = np.radians(4.0)
    assert abs(abs(found.axis_rates.value[0]) - spin) < 5.0 * found.axis_rates.sigma[0]
    period = 2.0 * np.pi / (spin * 0.4)
    assert abs(found.nutation_period.value[0] - period) < 5.0 * found.nutation_period.sigma[0]
    angle = np.arctan2(3.0, 0.6 * 4.0)
    assert abs(found.nutation_angle.value[0] - angle) < 5.0 * found.nutation_angle.sigma[0]


def test_steady_spin_leaves_the_inertia_undefined(body_of) -> None:
    truth = body_of(np.arange(0.0, 300.0), [0.0, 0.0, 4.0], [1.0, 0.8, 0.6])
    motion = measured(truth, 2)
    found = derived(motion.arc, motion.claimed)
    assert np.isnan(found.moments.value).all()
    assert np.isnan(found.nutation_period.value).all()
    axis, sigma = truth.attitude[0].apply([0.0, 0.0, 1.0]), np.linalg.norm(found.spin_axis.sigma)
    assert np.linalg.norm(np.cross(found.spin_axis.value, axis)) < 5.0 * sigma
    assert abs(found.speed.value[0] - np.radians(4.0)) < 5.0 * found.speed.sigma[0]
