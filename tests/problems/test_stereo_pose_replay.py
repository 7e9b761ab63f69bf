"""Charts, arcs and start-up of the stereo pose problem."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.filters.replay.measured_arc import linearize, measured_arc
from debrisest.filters.replay.replay import replay
from debrisest.problems.stereo_pose import model as stereo_pose

POINTS = 5


TURNED = (0.5, -0.5, 0.5, 0.5)
"""Cameras that look along another of the leader's axes."""


@pytest.fixture(scope="module")
def slow(experiment):
    return experiment(2, 7, 0, slow=True)


def differences(function, size, step=1e-6):
    """Central differences of a function of ``size`` errors, the last axis."""
    columns = [(function(e) - function(-e)) / (2 * step) for e in step * np.eye(size)]
    return np.moveaxis(columns, 0, -1)


def in_plain_chart(state, error):
    """Plain errors applied one by one, as their names say."""
    moved = state.copy()
    moved[:, :9] += error[:9]
    moved[:, 9:13] = quaternion.multiply(quaternion.exp(error[9:12]), state[:, 9:13])
    moved[:, 13:] += error[12:]
    return moved


def test_charts(slow):
    model, state = slow.model, slow.truth[:, 5]
    found = differences(lambda e: model.difference(in_plain_chart(state, e), state), 29)
    np.testing.assert_allclose(model.chart(state), found, atol=1e-7)
    unit = model.chart(state) @ model.inverse_chart(state)
    np.testing.assert_allclose(unit, np.broadcast_to(np.eye(29), unit.shape), atol=1e-7)
    plain = differences(lambda e: model.plain_difference(in_plain_chart(state, e), state), 29)
    np.testing.assert_allclose(plain, np.broadcast_to(np.eye(29), plain.shape), atol=1e-7)


def test_retract_and_difference_are_inverse(slow):
    error = 1e-2 * np.random.default_rng(0).normal(size=(2, 29))
    error[:, 12:14] = 0.0
    state = slow.truth[:, 3]
    moved = slow.model.retract(state, error)
    np.testing.assert_allclose(slow.model.difference(moved, state), error, atol=1e-7)


def test_what_cameras_show_depends_on_the_points_alone(slow):
    """Along position, attitude and ratios the chart leaves everything in view as it is."""
    known = slow.known._replace(shown=stereo_pose.Shown())
    state = slow.truth[:, 3]
    error = np.zeros((2, 29))
    error[:, [0, 1, 2, 9, 10, 11, 12, 13]] = 0.1
    moved = slow.model.retract(state, error)
    np.testing.assert_allclose(
        stereo_pose.measurement(known, moved, 3),
        stereo_pose.measurement(known, state, 3),
        atol=1e-13,
    )


def test_arcs_match_steps_and_rewind(slow):
    model = slow.model
    states, _ = model.trajectory(slow.prior, 0, 6)
    state = slow.prior
    for k in range(6):
        state = stereo_pose.process(slow.known, state, k)
        np.testing.assert_allclose(states[:, k + 1], state, atol=1e-7)
    np.testing.assert_allclose(model.rewind(states[:, 6], 6), slow.prior, atol=1e-9)
    back, _ = model.trajectory(states[:, 6], 6, 4)
    np.testing.assert_allclose(back[:, -1], states[:, 4], atol=1e-9)


@pytest.mark.parametrize("q_lc", [(1, 0, 0, 0), TURNED])
def test_what_a_motion_shows_is_the_same_without_derivatives(experiment, q_lc):
    slow = experiment(3, 7, 1, slow=True, q_lc=q_lc)
    states, sensitivity = slow.model.trajectory(slow.prior, 0, 6)
    expected, _ = slow.model.rows(states, sensitivity, 0, np.arange(7))
    for model in (slow.model, slow.model._replace(course=None)):
        course, shown = model.shown(slow.prior, 6)
        np.testing.assert_allclose(course, states, atol=1e-12)
        np.testing.assert_allclose(shown, expected, atol=1e-13)


@pytest.mark.parametrize("first", [0, 4])
@pytest.mark.parametrize("q_lc", [(1, 0, 0, 0), TURNED])
def test_derivatives_match_differences(experiment, first, q_lc):
    slow = experiment(3, 7, 1, slow=True, q_lc=q_lc)
    model, state, epochs = slow.model, slow.prior, np.arange(first, 7)

    def shown(error):
        moved = in_plain_chart(state, error)
        return model.rows(*model.trajectory(moved, first, 6), first, epochs)[0]

    def end(error):
        moved = in_plain_chart(state, error)
        return model.plain_difference(model.trajectory(moved, first, 6)[0][:, -1], states[:, -1])

    states, sensitivity = model.trajectory(state, first, 6)
    predicted, derivative = model.rows(states, sensitivity, first, epochs)
    expected = [stereo_pose.measurement(slow.known, states[:, j], k) for j, k in enumerate(epochs)]
    np.testing.assert_allclose(predicted, np.stack(expected, axis=1), atol=1e-15)
    np.testing.assert_allclose(derivative, differences(shown, 29), atol=2e-7)
    np.testing.assert_allclose(
        model.transition(sensitivity[:, -1], first, 6), differences(end, 29), atol=2e-6
    )


@pytest.mark.parametrize("acceleration", [False, True])
def test_sums_by_points_are_those_of_all_rows(experiment, acceleration):
    test = experiment(3, 20, 0, shown=stereo_pose.Shown(acceleration=acceleration), slow=True)
    measured = test.exact + test.model.sigma * np.random.default_rng(4).normal(
        size=test.exact.shape
    )
    measured[0, 3:5, :9], measured[1, 7, 2] = np.nan, np.nan
    arc = measured_arc(test.model, test.prior, np.tile(np.eye(29), (3, 1, 1)), measured)
    found = linearize(test.model, arc, test.prior, 19)
    dense = linearize(test.model._replace(point_rows=None), arc, test.prior, 19)
    for one, other in zip(found, dense):
        np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-13 * np.abs(other).max())


def test_no_run_depends_on_those_beside_it(experiment):
    """Fast and slow targets, first seen at different epochs, together and alone, to the bit."""
    test = experiment(4, 12, 2)
    measured, covariance = test.exact.copy(), np.tile(np.eye(29), (4, 1, 1))
    measured[1, :2] = np.nan
    together = replay(test.model, test.prior, covariance, measured, gate=True, keep=(5,))
    for run in range(4):
        one = slice(run, run + 1)
        alone = replay(
            test.model, test.prior[one], covariance[one], measured[one], gate=True, keep=(5,)
        )
        np.testing.assert_array_equal(together.state[one], alone.state)
        np.testing.assert_array_equal(together.covariance[one], alone.covariance)
        np.testing.assert_array_equal(together.counts["cost"][one], alone.counts["cost"])


@pytest.mark.parametrize("shown", [stereo_pose.Shown(), stereo_pose.Shown(True, False, False)])
@pytest.mark.parametrize("q_lc", [(1, 0, 0, 0), TURNED])
def test_the_start_agrees_with_the_first_frame(experiment, shown, q_lc):
    """Without noise: points exactly, and flow too where it is measured."""
    test = experiment(4, 2, 3, shown=shown, q_lc=q_lc)
    start = test.model.start(test.prior, test.exact[:, 1], 1)
    later = stereo_pose.process(test.known, start, 0)
    point, velocity = stereo_pose.points_in_view(later, POINTS)
    true_point, true_velocity = stereo_pose.points_in_view(test.truth[:, 1], POINTS)
    assert np.abs(point - true_point).max() < 0.02
    if shown.flow:
        assert np.abs(velocity - true_velocity).max() < 0.01


def test_the_start_is_the_priors_where_nothing_is_seen(slow):
    shown = np.full_like(slow.measured[:, 1], np.nan)
    start = slow.model.start(slow.prior, shown, 1)
    state = stereo_pose.process(slow.known, start, 0)
    expected = stereo_pose.process(slow.known, slow.prior, 0)
    point, _ = stereo_pose.points_in_view(state, POINTS)
    np.testing.assert_allclose(point, stereo_pose.points_in_view(expected, POINTS)[0], atol=1e-2)


def test_turned_cameras_estimate_as_well(experiment):
    """NEES by chi-square: 29 errors of 40 runs, after 12 s."""
    test = experiment(40, 12, 7, q_lc=TURNED)
    found = test.estimate()
    error = test.model.difference(test.truth[:, -1], found.state[:, -1])
    robocentric = test.model.chart(found.state[:, -1])
    covariance = robocentric @ found.covariance[:, -1] @ np.swapaxes(robocentric, -1, -2)
    solved = np.linalg.solve(covariance, error[..., None])[..., 0]
    nees = (error * solved).sum(-1) / 29
    assert np.median(nees) == pytest.approx(1.0, abs=5 * 1.25 * np.sqrt(2 / 29 / 40))
