"""From datasets to the stereo pose model and back, and the scores."""

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.filters.estimates import Estimates
from debrisest.problems.stereo_pose import chart
from debrisest.problems.stereo_pose import data as of_data
from debrisest.problems.stereo_pose.model import RATE, K, Q, measurement
from debrisest.problems.stereo_pose.problem import StereoPose, StereoPoseAdditive
from debrisest.problems.stereo_pose.replay import point_rows
from debrisest.problems.stereo_pose.score import plain_covariance, scores

POINTS, EPOCHS = 5, 4
FOCAL = 800.0
CLOCK = Clock.regular(float(EPOCHS), 1.0)


@pytest.fixture(scope="module")
def states():
    rng = np.random.default_rng(3)
    states = rng.normal(size=(2, EPOCHS, 15 + 3 * POINTS))
    states[..., 1] += 60
    states[..., Q] = quaternion.normalize(states[..., Q])
    states[..., 13:] = states[:, :1, 13:]
    return states


@pytest.fixture(scope="module")
def data(states):
    """Datasets of a truth, noise-free cameras, and a first guess."""
    parts = of_data.parts_of(states)
    truth = {f"true_{name}": values for name, values in parts.items()}
    truth |= {f"true_{name}": parts[name][:, 0] for name in ("inertia_ratio", "point_b")}
    start = {f"start_{name}": values[:, 0] for name, values in parts.items()}
    start |= {f"{name}_sigma": np.full(values.shape, 0.3) for name, values in start.items()}
    orbit = {"orbit_position": np.zeros((2, EPOCHS, 3)), "orbit_velocity": np.zeros((2, EPOCHS, 3))}
    orbit["orbit_position"][..., 0] = 7e6
    orbit["orbit_velocity"][..., 1] = 7.6e3
    body = quaternion.rotate(parts["q_lt"][..., None, :], parts["point_b"])
    x, y, z = np.moveaxis(parts["position"][..., None, :] + body, -1, 0)
    pixel = np.stack([np.stack([(x - b) / y, z / y], -1) for b in (0.0, 2.0)], axis=2)
    return {
        "time_s": CLOCK.times,
        "baseline": np.full(2, 2.0),
        "focal_px": np.full(2, FOCAL),
        "measured_pixel": FOCAL * pixel,
        "pixel_noise": np.full(2, FOCAL * 1e-5),
        "measured_disparity": -2.0 * FOCAL / y,
        "disparity_noise": np.full(2, FOCAL * 3e-5),
        "measured_angular_acceleration": np.zeros((2, EPOCHS, 3)),
        "angular_acceleration_noise": np.full(2, 1e-6),
        **truth,
        **start,
        **orbit,
    }


def test_states_and_parts_are_inverse(states, data):
    assert np.array_equal(of_data.state_of(of_data.parts_of(states)), states)
    assert np.array_equal(of_data.state_of(data, "true_"), states)
    assert np.array_equal(of_data.state_of(data, "start_"), states[:, 0])


@pytest.mark.parametrize("measures", [None, ["pixels"], ["disparity", "pixels"]])
def test_rows_come_in_the_order_of_the_model(data, states, measures):
    known = of_data.geometry_of(data, CLOCK, measures)
    found = of_data.measured_of(data, known.shown)
    expected = np.stack([measurement(known, states[:, k], k) for k in range(EPOCHS)], axis=1)
    count = expected.shape[-1] - 3 * known.shown.acceleration
    assert found[..., :count] == pytest.approx(expected[..., :count], abs=1e-12)
    assert found.shape == expected.shape
    noise = of_data.noise_of(data, known)
    assert noise.shape == expected.shape[-1:]
    per_point = [1e-5] * 4 + [3e-5] * known.shown.disparity
    assert noise[:count] == pytest.approx(per_point * POINTS, rel=1e-15)
    assert set(noise[count:]) <= {1e-6}


def test_the_acceleration_alone_has_three_rows(data, states):
    known = of_data.geometry_of(data, CLOCK, ["acceleration"])
    epochs = np.arange(EPOCHS)
    slow = states[:, 0].copy()
    slow[:, RATE], slow[:, K] = 0.01, 0.1
    course, turning = chart.propagate(known, slow, 0, EPOCHS - 1)
    rows = point_rows(known, course, turning, np.tile(np.eye(6), (EPOCHS, 1, 1)), epochs)
    assert rows.shown.shape == of_data.measured_of(data, known.shown).shape == (2, EPOCHS, 3)
    assert rows.derivative().shape == (2, EPOCHS, 3, 14 + 3 * POINTS)


def test_what_no_sensor_measures_is_told(data):
    problem = StereoPose(kind="stereo_pose", measures=["flow"])
    with pytest.raises(ValueError, match=r"flow cannot be used.*measured: pixels, disparity"):
        problem.measurements(data)


def test_the_covariance_of_both_charts_is_the_same(data):
    guess = {name: data[f"start_{name}"] for name in of_data.NAMES}
    variance = {name: np.full(v.shape, 0.01 * (i + 1)) for i, (name, v) in enumerate(guess.items())}
    state, additive = StereoPoseAdditive(kind="stereo_pose_additive").pack(guess, variance)
    _, plain = StereoPose(kind="stereo_pose").pack(guess, variance)
    assert plain.shape == (2, 29, 29)
    assert plain_covariance(state, additive) == pytest.approx(plain, abs=1e-12)


def test_an_angle_spreads_the_quaternion(states):
    """Against samples: the sigma of each component for uncorrelated errors of the angles."""
    state, sigma = states[:1, :1], np.full((1, 1, 29), 1e-3)
    sigma[..., 9:12] = [1e-3, 2e-3, 4e-3]
    nothing = np.zeros((1, 1, 1))
    filtered = Estimates(state, sigma, nothing, np.array([0]), nothing, nothing, np.array([""]))
    found = StereoPose(kind="stereo_pose").unpack(filtered)["q_lt_sigma"][0, 0]
    turns = sigma[0, 0, 9:12] * np.random.default_rng(1).normal(size=(20000, 3))
    spread = quaternion.multiply(quaternion.exp(turns), state[0, 0, Q]).std(0)
    assert found == pytest.approx(spread, rel=0.04, abs=1e-6)


def test_displacing_is_the_inverse_of_the_difference(states):
    """Exactly, also where the ratios leave what is physical."""
    first, second = states[:, 0], states[:, 1] + 0.0
    second[:, 13:15] += 3.0
    error = chart.difference(second, first, POINTS)
    found = chart.displace(first, error, POINTS)
    same_sign = np.sign((found[:, Q] * second[:, Q]).sum(-1, keepdims=True))
    second[:, Q] *= same_sign
    assert found == pytest.approx(second, abs=1e-9)


def estimate(states, epochs=EPOCHS):
    return of_data.parts_of(states) | {
        "covariance_time_s": np.array([1.0, 3.0]),
        "covariance": np.tile(np.eye(29), (2, 2, 1, 1)),
    }


def test_scores_of_known_errors(data, states):
    moved = states.copy()
    moved[..., 0] += 3.0
    moved[..., 1] -= 4.0
    moved[..., 14] -= 0.5
    turn = quaternion.exp(np.array([0.0, 0.2, 0.0]))
    moved[..., Q] = quaternion.multiply(turn, states[..., Q])
    result = scores(data | estimate(moved), 0)
    ones = np.ones((2, EPOCHS))
    for name, value in (("position", 5), ("attitude", 0.2), ("k1", 0), ("k2", 0.5)):
        assert result[name] == pytest.approx(value * ones, abs=1e-9)
    assert result["position_error"][0, 0] == pytest.approx([3, -4, 0], abs=1e-9)
    assert np.isnan(result["nees"][:, [0, 2]]).all()
    assert result["nees_dof"][0].tolist() == [0, 29, 0, 29]


def test_a_late_truth(data, states):
    late = scores(data | estimate(states), 1)
    gap = np.linalg.norm(states[:, 1:, :3] - states[:, :-1, :3], axis=-1)
    assert late["position"][:, :-1] == pytest.approx(gap, abs=1e-12)
    assert np.isnan(late["position"][:, -1]).all()


def test_without_a_truth_there_are_no_errors(data, states):
    measured = {name: value for name, value in data.items() if not name.startswith("true_")}
    assert scores(measured | estimate(states), 0) == {}


def test_nees_follows_the_covariance(data, states):
    """Errors drawn from a covariance of the robocentric chart give one per dimension."""
    rng = np.random.default_rng(5)
    truth = np.repeat(states[:1], 400, axis=0)
    sigma = 10.0 ** rng.uniform(-5, -2, 29)
    error = sigma * rng.normal(size=(400, EPOCHS, 29))
    found = chart.displace(truth, error, POINTS)
    kept = found[:, [1, 3]]
    back = chart.plain(kept, POINTS)
    many = estimate(found) | {"covariance": back * sigma**2 @ np.swapaxes(back, -1, -2)}
    true = of_data.parts_of(truth)
    many |= {f"true_{name}": values for name, values in true.items()}
    many |= {f"true_{name}": true[name][:, 0] for name in ("inertia_ratio", "point_b")}
    many |= {"time_s": CLOCK.times}
    nees = scores(many, 0)["nees"][:, [1, 3]]
    assert nees.mean() == pytest.approx(1, abs=5 * np.sqrt(2 / (29 * nees.size)))
