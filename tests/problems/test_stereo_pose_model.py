"""The additive model of the stereo pose problem against exact motion and differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.clock import Clock
from debrisest.filters.kalman.unscented import unscented
from debrisest.problems.stereo_pose import additive, chart
from debrisest.problems.stereo_pose import model as stereo_pose
from debrisest.problems.stereo_pose.truth import draw_guess, simulate_truth

ORBIT = (7.17e6, 0.05, 0.0)
SHOWN = stereo_pose.Shown(acceleration=True)


def starts(runs=3, points=4, seed=0, rate=(-1.0, -1.0, 0.934)):
    state = np.zeros((runs, 15 + 3 * points))
    state[:, :9] = [10, 60, 10, 0.01, -0.0225, -0.01, *np.radians(rate)]
    state[:, 9:15] = [0, 0, 0, 1, -0.186, -0.0797]
    state[:, 15:] = np.random.default_rng(seed).uniform(-1.5, 1.5, (runs, 3 * points))
    return state


def any_states(seed=1):
    state = starts()
    rng = np.random.default_rng(seed)
    state[:, 9:13] = 1.1 * rng.normal(size=(3, 4))
    return state + 1e-2 * rng.normal(size=state.shape)


UNEVEN = np.cumsum(np.random.default_rng(5).uniform(0.4, 1.2, 101)) - 0.4


@pytest.mark.parametrize("times", [np.arange(101.0), UNEVEN])
def test_process_follows_the_exact_motion(times):
    known = stereo_pose.stereo_geometry(Clock(times), *ORBIT, points=4)
    truth = simulate_truth(times, starts(), *ORBIT)
    state = truth[:, 0]
    for k in range(100):
        state = stereo_pose.process(known, state, k)
    np.testing.assert_allclose(state[:, :3], truth[:, -1, :3], atol=1e-7)
    np.testing.assert_allclose(state[:, 3:6], truth[:, -1, 3:6], atol=1e-9)
    np.testing.assert_allclose(state[:, 6:9], truth[:, -1, 6:9], atol=1e-9)
    np.testing.assert_allclose(state[:, 9:13], truth[:, -1, 9:13], atol=1e-8)
    np.testing.assert_array_equal(state[:, 13:], truth[:, -1, 13:])


def test_replays_at_uneven_times_follow_the_exact_motion_both_ways():
    known = stereo_pose.stereo_geometry(Clock(UNEVEN), *ORBIT, points=4)
    truth = simulate_truth(UNEVEN, starts(), *ORBIT)
    for first, last in ((0, 40), (40, 0)):
        states, _ = chart.propagate(known, truth[:, first], first, last)
        np.testing.assert_allclose(states[:, -1], truth[:, last], atol=1e-7)
    np.testing.assert_allclose(chart.rewind(known, truth[:, 40], 40), truth[:, 0], atol=1e-7)


@pytest.mark.parametrize(("rate", "size"), [((-0.1, -0.1, 0.034), 0.1), ((-1, -1, 0.934), 1.0)])
def test_initial_rates_of_the_target_are_round(rate, size):
    state = starts(rate=rate)
    known = stereo_pose.stereo_geometry(Clock.regular(1, 1.0), *ORBIT, points=4)
    total = state[0, 6:9] + [0.0, 0.0, known.leader.rate[0]]
    rate_t = Rotation.from_quat(state[0, 9:13], scalar_first=True).inv().apply(total)
    np.testing.assert_allclose(np.degrees(rate_t), size, atol=1e-4)


def test_measurements_of_the_exact_motion():
    """Pixels by hand; flow and angular acceleration by differences of the motion itself."""
    known = stereo_pose.stereo_geometry(Clock.regular(1, 1.0), *ORBIT, points=4, shown=SHOWN)
    step = 0.01
    truth = simulate_truth(np.array([0.0, step, 2 * step]), starts(), *ORBIT)
    middle = stereo_pose.stereo_geometry(Clock.regular(1, 1.0), *ORBIT, points=4)
    pixels = []
    for k in range(3):
        turn = Rotation.from_quat(truth[:, k, 9:13], scalar_first=True).as_matrix()
        points = truth[:, k, None, :3] + truth[:, k, 15:].reshape(3, 4, 3) @ turn.swapaxes(1, 2)
        x, y, z = np.moveaxis(points, -1, 0)
        pixels.append(np.stack([x / y, z / y, (x - 1) / y, z / y], axis=-1))
    shown = stereo_pose.measurement(middle, truth[:, 1], 0).reshape(3, 4, 9)
    np.testing.assert_allclose(shown[..., :4], pixels[1], atol=1e-13)
    np.testing.assert_allclose(shown[..., 4:8], (pixels[2] - pixels[0]) / (2 * step), atol=1e-9)
    np.testing.assert_allclose(shown[..., 8], -1 / y, rtol=1e-3)
    acceleration = stereo_pose.measurement(known, truth[:, 0], 0)[:, -3:]
    spin = [0.0, 0.0, known.leader.rate[0]]
    rates = [
        Rotation.from_quat(truth[:, k, 9:13], scalar_first=True)
        .inv()
        .apply(truth[:, k, 6:9] + spin)
        for k in range(2)
    ]
    np.testing.assert_allclose(acceleration, (rates[1] - rates[0]) / step, atol=1e-6)


@pytest.mark.parametrize(("raw", "turned"), [(False, False), (True, False), (False, True)])
def test_jacobians_match_differences(raw, turned):
    known = stereo_pose.stereo_geometry(
        Clock.regular(3, 1.0), *ORBIT, points=4, shown=SHOWN, raw_rotation=raw
    )
    if turned:
        known = known._replace(to_camera=Rotation.from_rotvec([0.2, -0.3, 0.4]).as_matrix())
    state = any_states()
    for function, jacobian in (
        (stereo_pose.process, additive.process_jacobian),
        (stereo_pose.measurement, additive.measurement_jacobian),
    ):
        differenced = []
        for change in 1e-5 * np.eye(state.shape[-1]):
            ahead, behind = function(known, state + change, 1), function(known, state - change, 1)
            differenced.append((ahead - behind) / 2e-5)
        np.testing.assert_allclose(
            jacobian(known, state, 1), np.moveaxis(differenced, 0, -1), atol=2e-8
        )


def test_printed_transition_is_right_to_first_order():
    state = any_states()
    gaps = []
    for step in (0.02, 0.01):
        known = stereo_pose.stereo_geometry(Clock.regular(3, step), *ORBIT, points=4)
        printed = additive.first_order_transition(known, state, 0)
        gaps.append(np.abs(printed - additive.process_jacobian(known, state, 0)).max())
    assert 3.5 < gaps[0] / gaps[1] < 4.5


def test_only_the_raw_rotation_uses_the_norm_of_the_quaternion():
    state = any_states()
    scaled = state.copy()
    scaled[:, 9:13] *= 1.001
    for raw in (False, True):
        known = stereo_pose.stereo_geometry(
            Clock.regular(3, 1.0), *ORBIT, points=4, shown=SHOWN, raw_rotation=raw
        )
        shown = [stereo_pose.measurement(known, s, 0) for s in (state, scaled)]
        after = [stereo_pose.process(known, s, 0) for s in (state, scaled)]
        assert np.allclose(*shown, rtol=0, atol=1e-13) is not raw
        assert np.allclose(after[0][:, :9], after[1][:, :9], rtol=0, atol=1e-13) is not raw


def test_groups_can_be_switched_off():
    state = starts()
    everything = stereo_pose.stereo_geometry(Clock.regular(1, 1.0), *ORBIT, points=4, shown=SHOWN)
    rows = stereo_pose.measurement(everything, state, 0)[:, :36].reshape(3, 4, 9)
    for shown, part in (
        (stereo_pose.Shown(True, False, False), rows[..., :4]),
        (stereo_pose.Shown(False, True, False), rows[..., 4:8]),
        (stereo_pose.Shown(True, False, True), rows[..., [0, 1, 2, 3, 8]]),
    ):
        known = everything._replace(shown=shown)
        np.testing.assert_array_equal(stereo_pose.measurement(known, state, 0), part.reshape(3, -1))
        assert additive.measurement_jacobian(known, state, 0).shape[-2] == part[0].size


def test_guesses_scatter_as_the_variance_says():
    truth, rng = starts(runs=4000), np.random.default_rng(5)
    variance = np.repeat([1.0, 1e-5, 0.5], [9, 4, 14])
    guess = draw_guess(truth, variance, rng.normal(size=truth.shape))
    np.testing.assert_allclose(np.linalg.norm(guess[:, 9:13], axis=-1), 1.0)
    spread = (guess - truth).var(axis=0)
    np.testing.assert_allclose(spread[:9], 1.0, rtol=0.15)
    np.testing.assert_allclose(spread[13:], 0.5, rtol=0.15)
    turn = (
        Rotation.from_quat(guess[:, 9:13], scalar_first=True)
        * Rotation.from_quat(truth[:, 9:13], scalar_first=True).inv()
    )
    np.testing.assert_allclose(turn.as_rotvec().var(axis=0), 4e-5, rtol=0.15)


def test_a_filter_can_be_handed_the_model():
    """From a good start, with the centre of mass known: nothing but the interface is tested."""
    known = stereo_pose.stereo_geometry(Clock.regular(6, 1.0), *ORBIT, points=4)
    truth = simulate_truth(np.arange(6.0), starts(), *ORBIT)
    shown = np.stack([stereo_pose.measurement(known, truth[:, k], k) for k in range(6)], axis=1)
    n = truth.shape[-1]
    model = additive.additive_model(known, 1e-12 * np.eye(n), 1e-10 * np.eye(36))
    start = np.tile(1e-8 * np.eye(n), (3, 1, 1))
    history = unscented(model, truth[:, 0] + 1e-4, start, shown)
    assert np.all(history.status == "finished")
    assert len(model.error_names) == n
    assert np.abs(history.state[:, -1, :3] - truth[:, -1, :3]).max() < 1e-3
