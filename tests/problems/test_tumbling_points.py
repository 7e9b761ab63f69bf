"""Tracked points of a tumbling body: rows, motion and derivatives, against integration."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from debrisest.problems.tumbling import points_motion as body
from debrisest.problems.tumbling.points_axes import in_principal_axes, rate_by_errors, sigmas
from debrisest.problems.tumbling.points_contrasts import compared, contrasts
from debrisest.problems.tumbling.points_inertia import log_inertia, log_tensor
from debrisest.problems.tumbling.points_replay import replay_model

POINTS = np.array([[0, 0, 0], [2, 0, 0], [0.5, 0, -1], [-1, 2, 0.3], [0.2, -1, 2], [1, 1, 1.0]])
TIMES = np.arange(0.0, 60.0)


def states(runs, seed):
    """Random tumbling bodies with inertia tensors of every direction."""
    rng = np.random.default_rng(seed)
    q = Rotation.random(runs, random_state=seed).as_quat(scalar_first=True)
    rate = 0.08 * rng.normal(size=(runs, 3))
    inertia = rng.normal(scale=0.15, size=(runs, 5))
    return np.concatenate([q, rate, inertia], axis=-1)


masks = hnp.arrays(bool, st.tuples(st.integers(1, 4), st.integers(2, 7)))


@given(masks)
def test_contrasts_are_orthonormal_and_know_no_translation(seen):
    """As rows of a matrix: white noise stays white, and nothing but the mean is lost."""
    count = seen.shape[-1]
    for mask in seen:
        used = compared(mask)
        unit = np.eye(count)[:, :, None] * np.ones(3)
        matrix = np.stack([contrasts(column, mask)[:, 0] for column in unit], axis=-1)
        assert not matrix[~used].any()
        assert used.sum() == max(mask.sum() - 1, 0)
        np.testing.assert_allclose(
            matrix[used] @ matrix[used].T, np.eye(used.sum()), rtol=0, atol=1e-14
        )
        n = max(mask.sum(), 1)
        centring = np.diag(mask * 1.0) - np.outer(mask, mask) / n
        np.testing.assert_allclose(matrix.T @ matrix, centring, rtol=0, atol=1e-14)


def test_what_is_hidden_may_be_nan():
    seen = np.array([True, False, True, True, False, True])
    shown = np.where(seen[:, None], POINTS, np.nan)
    np.testing.assert_array_equal(contrasts(shown, seen), contrasts(POINTS, seen))


@given(st.integers(0, 2**32 - 1))
def test_coordinates_of_the_inertia(seed):
    state = states(1, seed)[0]
    inertia = expm(log_tensor(state[body.LOG_INERTIA]))
    assert np.linalg.det(inertia) == pytest.approx(1)
    found = log_inertia(3.7 * inertia)
    np.testing.assert_allclose(found, state[body.LOG_INERTIA], rtol=0, atol=1e-13)


def test_the_motion_is_that_of_the_textbook(integrated):
    all_states = states(4, 1)
    q, rate = body.motion(all_states, TIMES)
    matrix, rates = integrated(all_states, TIMES)
    found = Rotation.from_quat(q.reshape(-1, 4), scalar_first=True)
    turn = found * Rotation.from_matrix(matrix.reshape(-1, 3, 3)).inv()
    assert turn.magnitude().max() < 1e-8
    np.testing.assert_allclose(rate, rates, rtol=0, atol=1e-9)
    later = body.moved(all_states, TIMES[-1])
    np.testing.assert_allclose(later[:, body.RATE], rates[:, -1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(
        body.moved(body.moved(all_states, 700.0), -700.0), all_states, atol=1e-10
    )


def test_sensitivities_against_differences_of_integrated_motions(integrated, nudged):
    all_states = states(2, 2)
    _, sensitivity = body.trajectory(all_states, TIMES)
    for state, found in zip(all_states, sensitivity):
        moved = [nudged(state, index, s * 1e-5) for s in (1, -1) for index in range(3, 11)]
        matrix, rate = integrated(np.array(moved), TIMES)
        turn = Rotation.from_matrix((matrix[:8] @ matrix[8:].swapaxes(-1, -2)).reshape(-1, 3, 3))
        change = [turn.as_rotvec().reshape(8, -1, 3), rate[:8] - rate[8:]]
        expected = np.moveaxis(np.concatenate(change, axis=-1) / 2e-5, 0, -1)
        scale = np.abs(expected).max(axis=(0, 1))
        assert (np.abs(found - expected).max(axis=(0, 1)) < 1e-5 * scale).all()


@pytest.fixture(scope="module")
def model():
    """Three runs, each of which sees other points."""
    seen = np.random.default_rng(3).random((3, len(TIMES), len(POINTS))) < 0.6
    times = np.arange(float(len(TIMES)))
    return replay_model(np.tile(POINTS, (3, 1, 1)), seen, 0.05, times), seen


def test_replays_take_each_epochs_own_time(integrated):
    times = np.cumsum(np.random.default_rng(6).uniform(0.4, 1.6, len(TIMES)))
    seen = np.ones((2, len(TIMES), len(POINTS)), dtype=bool)
    known = replay_model(np.tile(POINTS, (2, 1, 1)), seen, 0.05, times)
    path, _ = known.trajectory(states(2, 4), 5, 40)
    _, rates = integrated(states(2, 4), times[5:41] - times[5])
    np.testing.assert_allclose(path[..., body.RATE], rates, rtol=0, atol=1e-9)
    back = known.trajectory(path[:, -1], 40, 5)[0]
    np.testing.assert_allclose(back[:, ::-1], path, atol=1e-9)
    np.testing.assert_allclose(
        known.rewind(path[:, -1], 40), body.moved(path[:, 0], times[0] - times[5]), atol=1e-9
    )


def test_rows_are_contrasts_of_the_turned_points_of_each_run(model, integrated):
    known, seen = model
    all_states, epochs = states(3, 4), np.array([0, 7, 30])
    path, sensitivity = known.trajectory(all_states, 0, 59)
    some = np.array([2, 0])
    shown, _ = known.of(some).rows(path[some][:, epochs], sensitivity[some][:, epochs], 0, epochs)
    matrix, _ = integrated(all_states, TIMES)
    for place, run in enumerate(some):
        for j, k in enumerate(epochs):
            moved = POINTS @ matrix[run, k].T + np.array([3.0, -20.0, 5.0])
            expected = contrasts(moved, seen[run, k]).ravel()
            np.testing.assert_allclose(shown[place, j], expected, rtol=0, atol=1e-8)


@pytest.mark.parametrize(("first", "last"), [(0, 20), (12, 30), (30, 12)])
def test_derivatives_match_differences(model, nudged, first, last):
    known, _ = model
    all_states, step = states(3, 5), 1e-6
    epochs = np.arange(first, last + np.sign(last - first), np.sign(last - first))

    def seen_from(index, sign):
        moved = np.array([nudged(state, index, sign * step) for state in all_states])
        path, sensitivity = known.trajectory(moved, first, last)
        return known.rows(path, sensitivity, first, epochs)[0], path[:, -1]

    path, sensitivity = known.trajectory(all_states, first, last)
    _, derivative = known.rows(path, sensitivity, first, epochs)
    transition = known.transition(sensitivity[:, -1], first, last)
    for index in range(11):
        (ahead, end_ahead), (back, end_back) = seen_from(index, 1), seen_from(index, -1)
        expected = (ahead - back) / (2 * step)
        np.testing.assert_allclose(derivative[..., index], expected, rtol=0, atol=1e-6)
        moved = known.plain_difference(end_ahead, end_back) / (2 * step)
        np.testing.assert_allclose(transition[..., index], moved, rtol=0, atol=1e-6)


def test_charts_and_rewind(model, nudged):
    known, _ = model
    all_states = states(3, 6)
    for index in range(11):
        moved = np.array([nudged(state, index, 0.1) for state in all_states])
        error = np.tile(0.1 * np.eye(11)[index], (3, 1))
        np.testing.assert_allclose(known.difference(moved, all_states), error, atol=1e-14)
        turned = known.difference(known.displace(all_states, error), all_states)
        np.testing.assert_allclose(turned, error, atol=1e-14)
    path, _ = known.trajectory(all_states, 0, 40)
    np.testing.assert_allclose(known.rewind(path[:, -1], 40), all_states, atol=1e-11)


@given(st.integers(0, 2**32 - 1), st.floats(0.1, 20))
def test_a_correction_leaves_a_possible_body(seed, size):
    rng = np.random.default_rng(seed)
    state, error = states(5, seed), size * rng.normal(size=(5, 11))
    moved = body.retract(state, error)
    free = body.displace(state, error)
    for one, other in zip(moved, free):
        logs = np.linalg.eigvalsh(log_tensor(one[body.LOG_INERTIA]))
        moments = np.exp(logs - logs.max())
        assert moments[2] <= (moments[0] + moments[1]) * (1 + 1e-9)
        wanted = np.exp(np.linalg.eigvalsh(log_tensor(other[body.LOG_INERTIA])))
        if wanted[2] < wanted[0] + wanted[1]:
            np.testing.assert_array_equal(one, other)


def test_principal_axes_of_an_estimate():
    all_states = states(3, 7)
    found = in_principal_axes(all_states[:, None])
    for run, state in enumerate(all_states):
        inertia = expm(log_tensor(state[body.LOG_INERTIA]))
        q_ib, q_bf = (
            Rotation.from_quat(found[name][run, 0], scalar_first=True) for name in ("q_ib", "q_bf")
        )
        diagonal = q_bf.as_matrix() @ inertia @ q_bf.as_matrix().T
        moments = np.diag(diagonal)
        np.testing.assert_allclose(diagonal, np.diag(moments), rtol=0, atol=1e-13)
        np.testing.assert_allclose(
            found["moments_b"][run, 0], moments / np.linalg.norm(moments), atol=1e-13
        )
        np.testing.assert_allclose(found["rate_b"][run, 0], q_bf.apply(state[body.RATE]))
        q_if = Rotation.from_quat(state[body.Q], scalar_first=True)
        assert (q_ib * q_bf * q_if.inv()).magnitude() < 1e-12


def test_axes_keep_their_labels():
    """Also where the two smaller moments change places from epoch to epoch."""
    path = np.repeat(states(2, 8)[:, None], 50, axis=1)
    path[..., body.LOG_INERTIA] = [-0.1, -0.1, 0, 0, 0]
    path[..., 7] += 1e-3 * np.random.default_rng(9).choice([-1, 1], size=(2, 50))
    axes = Rotation.from_quat(in_principal_axes(path)["q_bf"].reshape(-1, 4), scalar_first=True)
    turn = axes.as_matrix().reshape(2, 50, 3, 3)
    assert np.ptp(turn, axis=1).max() < 1e-12


def test_an_estimate_that_is_lost_has_no_axes():
    path = np.repeat(states(2, 8)[:, None], 4, axis=1)
    path[0, 2:] = np.nan
    found = in_principal_axes(path)
    assert all(np.isnan(value[0, 2:]).all() for value in found.values())
    assert all(np.isfinite(value[1]).all() for value in found.values())
    spread = sigmas(found, np.ones((2, 4, 11)))
    assert all(np.isfinite(value[1]).all() for value in spread.values())


@pytest.mark.parametrize("index", range(11))
def test_sigmas_are_first_order(index, nudged):
    state, step = states(4, 10), 1e-6
    moved = [
        in_principal_axes(np.stack([[nudged(one, index, s * step), one] for one in state], axis=0))
        for s in (1, -1)
    ]
    here = in_principal_axes(state[:, None])
    spread = sigmas(here, np.broadcast_to(np.eye(11)[index], (4, 1, 11)))
    for name in here:
        change = (moved[0][name][:, 0] - moved[1][name][:, 0]) / (2 * step)
        np.testing.assert_allclose(spread[f"{name}_sigma"][:, 0], np.abs(change), atol=1e-6)
    rate = (moved[0]["rate_b"][:, 0] - moved[1]["rate_b"][:, 0]) / (2 * step)
    np.testing.assert_allclose(rate_by_errors(moved[0])[:, 1, :, index], rate, atol=1e-6)
