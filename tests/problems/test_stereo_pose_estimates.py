"""The replay filter and its smoother on the stereo pose problem."""

import numpy as np
import pytest

from debrisest.assessment.consistency import chart_free
from debrisest.filters.bound.motion import paired_errors
from debrisest.filters.replay.gauss_newton import move
from debrisest.filters.replay.hindsight import with_hindsight
from debrisest.filters.replay.measured_arc import linearize, measured_arc
from debrisest.filters.replay.replay import replay, smooth
from debrisest.filters.replay.valley import with_bends
from debrisest.filters.status import ReplayStatus
from debrisest.filters.verdict import Verdict
from debrisest.problems.stereo_pose import model as stereo_pose
from debrisest.problems.stereo_pose.replay import replay_model

POINTS = 5


@pytest.fixture(scope="module")
def fast(experiment):
    return experiment(16, 15, 1)


def errors(test, states):
    return test.model.plain_difference(states, test.truth)


def test_filter_and_smoother_reach_the_bound(fast):
    """Limits are three sigma or more of 16 runs, whatever the seed."""
    last = fast.measured.shape[1] - 1
    filtered = fast.estimate()
    final = smooth(fast.model, fast.prior, fast.covariance, fast.measured, filtered)
    assert np.all(filtered.status == ReplayStatus.CONVERGED.sentence)
    assert np.all(final.status == ReplayStatus.CONVERGED.sentence)
    bound = paired_errors(
        fast.model, fast.truth[:, 0], fast.prior, fast.covariance[0], fast.measured
    )
    for states, efficient in (
        (filtered.state, bound.filter_error),
        (final.state, bound.smoother_error),
    ):
        for block in (slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)):
            size = np.linalg.norm(errors(fast, states)[:, -8:, block], axis=-1).mean(-1)
            least = np.linalg.norm(efficient[:, -8:, block], axis=-1).mean(-1)
            assert np.median(size) < 1.3 * np.median(least)
    arc = measured_arc(fast.model, fast.prior, fast.covariance, fast.measured)
    at_truth = linearize(fast.model, arc, fast.truth[:, 0], last).cost
    for cost in (filtered.counts["cost"][:, last], final.counts["cost"][:, last]):
        free = chart_free(at_truth, cost, 29)
        assert free.min() > 0
        assert 0.75 < free.mean() < 1.25
    assert filtered.nis[:, 4:].sum() / filtered.nis_dof[:, 4:].sum() == pytest.approx(1, abs=0.06)


def test_a_missing_row_is_a_row_left_out(experiment):
    """A point that is never seen gives what a setup without its rows gives, but for itself."""
    test = experiment(2, 7, 4)
    hidden = test.measured.copy()
    hidden.reshape(2, 7, POINTS, 9)[:, :, 4] = np.nan
    sigma = test.model.sigma[:36]
    plain = np.sqrt(np.diagonal(test.covariance[0]))
    known = test.known._replace(points=4)
    part = replay(
        replay_model(known, sigma, plain[:26]),
        test.prior[:, :27],
        test.covariance[:, :26, :26],
        test.measured[..., :36],
        ratio=1.0,
    )
    whole = replay(test.model, test.prior, test.covariance, hidden, ratio=1.0)
    sigma_of_part = part.sigma[:, -1, :9]
    gap = np.abs(whole.state[:, -1, :9] - part.state[:, -1, :9])
    assert np.all(gap < 0.05 * sigma_of_part)
    np.testing.assert_allclose(whole.sigma[:, -1, :9], sigma_of_part, rtol=0.02)


@pytest.mark.parametrize("gate", [False, True])
def test_rows_that_are_never_measured_are_rows_left_out(experiment, gate):
    """Pixels alone, once by a model without the other rows, once with NaN in their places."""
    pixels = stereo_pose.Shown(flow=False, disparity=False)
    whole, part = experiment(2, 7, 10), experiment(2, 7, 10, shown=pixels)
    rows = whole.measured.reshape(2, 7, POINTS, 9)
    part.measured = rows[..., :4].reshape(2, 7, -1).copy()
    rows[..., 4:] = np.nan
    masked, dropped = whole.estimate(gate=gate), part.estimate(gate=gate)
    assert np.abs((masked.state - dropped.state)[..., :9] / dropped.sigma[..., :9]).max() < 1e-5
    np.testing.assert_allclose(masked.sigma, dropped.sigma, rtol=1e-6)
    np.testing.assert_array_equal(masked.nis_dof, dropped.nis_dof)


def test_outliers_are_kept_out_by_the_gate_only(experiment):
    test = experiment(6, 9, 5)
    rng = np.random.default_rng(6)
    hit = rng.random(test.measured.shape) < 0.01
    test.measured = test.measured + hit * 1e-3 * rng.choice([-1, 1], hit.shape)
    gated, open_ = test.estimate(gate=True), test.estimate(gate=False)
    for estimates, good in ((gated, True), (open_, False)):
        normalized = (errors(test, estimates.state) / estimates.sigma)[:, -3:, 3:9]
        assert (np.median(np.abs(normalized)) < 2.0) == good
    assert gated.counts["rejected"].sum() > 0.5 * hit[:, 1:].sum()
    assert "rejected" not in open_.counts


def test_a_run_alone_is_the_run_in_a_batch(fast):
    alone = replay(fast.model, fast.prior[3:4], fast.covariance[3:4], fast.measured[3:4])
    batch = fast.estimate()
    np.testing.assert_allclose(alone.state[0], batch.state[3], rtol=0, atol=1e-8)


def test_the_step_promises_what_it_keeps(fast):
    """Near the minimum the cost falls by the decrement."""
    arc = measured_arc(fast.model, fast.prior, fast.covariance, fast.measured)
    at = linearize(fast.model, arc, fast.truth[:, 0], 14)
    step = np.linalg.solve(at.information, at.gradient[..., None])[..., 0]
    promised = (step * at.gradient).sum(-1)
    after = linearize(fast.model, arc, move(fast.model, at.state, step), 14).cost
    assert np.median(np.abs(at.cost - after - promised) / promised) < 0.3


def test_the_bound_leaves_outliers_out_and_keeps_covariances(experiment):
    """What is 100 sigma off is as good as missing; the kept covariances are those of the sigmas."""
    test = experiment(2, 6, 8)
    hit = np.random.default_rng(9).random(test.measured.shape) < 0.05
    wild, holes = test.measured + 1e-3 * hit, np.where(hit, np.nan, test.measured)
    found, expected = (
        paired_errors(test.model, test.truth[:, 0], test.prior, test.covariance[0], y, [0, 5])
        for y in (wild, holes)
    )
    for values, others in zip(found, expected):
        np.testing.assert_array_equal(values, others)
    for covariance, sigma in (
        (found.filter_covariance, found.filter_sigma),
        (found.smoother_covariance, found.smoother_sigma),
    ):
        spread = np.sqrt(np.diagonal(covariance, 0, -2, -1))
        np.testing.assert_allclose(spread, sigma[:, [0, 5]], rtol=1e-12)


def test_where_all_runs_are_lost_there_is_nothing_to_smooth(experiment):
    test = experiment(2, 4, 3)
    lost = replay(test.model, np.inf * test.prior, test.covariance, test.measured)
    final = smooth(test.model, test.prior, test.covariance, test.measured, lost)
    assert np.isnan(final.state[:, -1]).all()
    np.testing.assert_array_equal(final.status, lost.status)


def test_ratios_that_a_spin_does_not_tell_are_not_told_for_certain(experiment):
    """Of a spin about one axis the images show a tilt times a slope of the inertia, no more."""
    test = experiment(16, 101, 3, rate=(0.0, 0.0, 2.0))
    found = test.estimate()
    told = with_bends(test.model, test.prior, test.covariance, test.measured, found)
    off = np.abs(errors(test, found.state)[:, -1])
    ratios = slice(12, 14)
    assert np.sum(off[:, ratios] / found.sigma[:, -1, ratios] > 5.0) > 2
    assert np.max(off / told.sigma[:, -1]) < 5.0
    assert np.mean((off / told.sigma[:, -1]) ** 2) > 0.6, "sigmas that are too large tell nothing"


def test_where_all_runs_are_lost_every_epoch_is(experiment):
    test = experiment(2, 4, 3)
    lost = replay(test.model, np.inf * test.prior, test.covariance, test.measured, keep=[1])
    lost = lost._replace(counts=lost.counts | {"doubt": np.full(2, Verdict.LOST)})
    code = with_hindsight(test.model, lost).counts["doubt_at"]
    np.testing.assert_array_equal(code, np.tile([np.nan, 3.0, np.nan, 3.0], (2, 1)))
