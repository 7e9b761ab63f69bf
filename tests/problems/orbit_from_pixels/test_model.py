"""The model of a debris orbit in pixels, against formulas that are written out here."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from debrisest.dynamics import kepler


def test_the_first_pixels_and_ranges_are_those_of_the_table(two_observers) -> None:
    data = two_observers(2).data
    expected = [[125.187, -34.699], [228.944, -42.823]]
    np.testing.assert_allclose(data["true_pixel"][0, 0], expected, atol=2e-3)
    away = data["orbit_position"][0, 0] - data["observer_position"][0, 0]
    np.testing.assert_allclose(np.linalg.norm(away, axis=-1) / 1e3, [1235.97, 1355.30], atol=0.02)


def test_the_truth_shows_the_true_pixels(two_observers) -> None:
    scene = two_observers(2)
    problem = scene.problem()
    model, truth = problem.model(scene.data, scene.CLOCK), problem.truth(scene.data)
    for k in (0, 24, 40, 300, 469):
        shown = model.points(truth[:, k], k)
        np.testing.assert_allclose(shown, scene.data["true_pixel"][:, k], atol=1e-6)


def test_known_errors_of_the_attitude_are_undone(two_observers) -> None:
    scene = two_observers(3, bias_mrad=10.0)
    problem = scene.problem(attitude_bias=True)
    model, truth = problem.model(scene.data, scene.CLOCK), problem.truth(scene.data)
    assert truth.shape == (3, 470, 12)
    blind = truth[:, 100].copy()
    blind[:, 6:] = 0.0
    true = scene.data["true_pixel"][:, 100]
    np.testing.assert_allclose(model.points(truth[:, 100], 100), true, atol=1e-6)
    assert np.abs(model.points(blind, 100) - true).max() > 1.0


def test_a_bias_is_the_turn_from_true_to_known_axes(two_observers) -> None:
    scene = two_observers(2, bias_mrad=10.0)
    truth = scene.problem(attitude_bias=True).truth(scene.data)
    true, known = (
        Rotation.from_quat(scene.data[name][1, 7, 1], scalar_first=True)
        for name in ("true_q_ic", "known_q_ic")
    )
    np.testing.assert_allclose(truth[1, 7, 9:12], (true.inv() * known).as_rotvec(), atol=1e-12)


@pytest.mark.parametrize("seed", [0, 1])
def test_derivatives_of_points_match_differences(two_observers, seed: int) -> None:
    scene, rng = two_observers(3, bias_mrad=10.0), np.random.default_rng(seed)
    problem = scene.problem(attitude_bias=True)
    model = problem.model(scene.data, scene.CLOCK)
    state = problem.truth(scene.data)[:, 80] + rng.normal(size=(3, 12)) * np.repeat(
        [1e4, 10.0, 0.02], [3, 3, 6]
    )
    step = np.repeat([10.0, 1.0, 1e-6], [3, 3, 6])
    copies = state[:, None, None] + np.array([1.0, -1.0])[:, None, None] * np.diag(step)
    shown = model.points(copies, 80)
    slope = np.moveaxis((shown[:, 0] - shown[:, 1]) / (2 * step[:, None, None]), 1, -1)
    found = model.points_jacobian(state, 80)
    np.testing.assert_allclose(found[..., :3], slope[..., :3], rtol=2e-6, atol=1e-10)
    np.testing.assert_allclose(found[..., 3:6], 0.0)
    np.testing.assert_allclose(slope[..., 3:6], 0.0, atol=1e-9)
    np.testing.assert_allclose(found[..., 6:], slope[..., 6:], rtol=1e-4, atol=2e-3)


def test_tracks_are_one_more_axis(two_observers) -> None:
    scene = two_observers(3, companions_km=10.0)
    problem = scene.problem(tracks="all")
    model, state, covariance, _ = scene.given(problem)
    assert state.shape == (3, 3, 6) and covariance.shape == (3, 3, 6, 6)
    for track in range(3):
        alone = state[:, track]
        for name in ("points", "points_jacobian", "process", "process_jacobian"):
            function = getattr(model, name)
            np.testing.assert_array_equal(function(state, 5)[:, track], function(alone, 5))
    np.testing.assert_allclose(covariance[1, 1], np.diag([1e8] * 3 + [1e4] * 3))
    np.testing.assert_allclose(covariance[1, 0], np.diag([1e4] * 6))


def test_some_runs_are_shown_what_they_are_among_all(two_observers) -> None:
    """With attitude errors of their own, and scales that differ."""
    scene = two_observers(3, bias_mrad=10.0)
    data = scene.data | {"focal_px": np.array([300.0, 335.0, 370.0])}
    problem, some = scene.problem(attitude_bias=True), np.array([2, 0])
    model, state = problem.model(data, scene.CLOCK), problem.truth(scene.data)[:, 30]
    assert np.ptp(model.points(state, 30), axis=0).min() > 1.0
    for name in ("points", "points_jacobian", "process", "process_jacobian"):
        part, whole = getattr(model.of(some), name), getattr(model, name)
        np.testing.assert_array_equal(part(state[some], 30), whole(state, 30)[some])


def test_without_companions_all_tracks_is_one(two_observers) -> None:
    _, state, covariance, _ = two_observers(2).given(two_observers(2).problem(tracks="all"))
    assert state.shape == (2, 1, 6) and covariance.shape == (2, 1, 6, 6)


def test_process_is_keplers_motion_and_biases_stay(two_observers) -> None:
    scene = two_observers(3, bias_mrad=10.0)
    problem = scene.problem(attitude_bias=True)
    model, truth = problem.model(scene.data, scene.CLOCK), problem.truth(scene.data)
    moved = model.process(truth[:, 10], 10)
    exact = kepler.propagate(truth[:, 10, :3], truth[:, 10, 3:6], np.array([1.0]))
    np.testing.assert_allclose(moved[:, :3], exact[0][:, 0], rtol=0, atol=1e-6)
    np.testing.assert_allclose(moved[:, 3:6], exact[1][:, 0], rtol=0, atol=1e-8)
    np.testing.assert_array_equal(moved[:, 6:], truth[:, 10, 6:])
    transition = model.process_jacobian(truth[:, 10], 10)
    np.testing.assert_array_equal(transition[:, 6:], np.eye(12)[6:] + np.zeros((3, 6, 12)))
    np.testing.assert_array_equal(transition[:, :6, 6:], 0.0)
    noise = model.process_noise
    assert np.linalg.matrix_rank(noise) == 3
    np.testing.assert_allclose(
        noise[:6, :6], 0.01 * np.kron([[0.25, 0.5], [0.5, 1.0]], np.eye(3)), rtol=1e-12
    )
    assert not noise[6:].any()


def test_what_is_behind_a_camera_cannot_be_predicted(two_observers) -> None:
    scene = two_observers(2)
    model, state, *_ = scene.given(scene.problem())
    behind = state.copy()
    behind[1, :3] = 2 * scene.data["observer_position"][1, 0, 0] - state[1, :3]
    shown, slope = model.points(behind, 0), model.points_jacobian(behind, 0)
    assert np.isfinite(shown[0]).all() and np.isnan(shown[1, 0]).all()
    assert np.isnan(slope[1, 0, :, :3]).all()


def test_points_are_left_out_while_cameras_turn(two_observers) -> None:
    scene = two_observers(4)
    every = scene.problem(updates_in_control=True).measurements(scene.data)
    some = scene.problem().measurements(scene.data)
    turning = scene.data["section"][0] % 2 == 1
    assert turning.sum() == 41
    assert np.isfinite(every[:, turning]).any() and np.isnan(some[:, turning]).all()
    np.testing.assert_array_equal(every[:, ~turning], some[:, ~turning])


def test_own_points_are_the_debris(two_observers) -> None:
    scene = two_observers(4)
    own = scene.problem(detections="own", updates_in_control=True).measurements(scene.data)
    assert own.shape[-2] == 1
    error = own[..., 0, :] - scene.data["true_pixel"]
    seen = np.isfinite(scene.data["true_pixel"])
    assert error[seen].std() == pytest.approx(np.sqrt(13 / 12), rel=0.05)


def test_bias_and_tracks_exclude_each_other(two_observers) -> None:
    with pytest.raises(ValidationError, match="not possible with tracks"):
        two_observers(2).problem(attitude_bias=True, tracks="all")


def test_errors_of_a_perfect_and_of_a_lost_estimate(two_observers) -> None:
    scene = two_observers(3, bias_mrad=10.0)
    data, runs = dict(scene.data), 3
    shift = np.zeros((runs, 470, 3))
    shift[1, 450:] = [6e3, 0.0, 0.0]
    shift[2, 450:] = np.nan
    data |= {
        "debris_position": data["orbit_position"] + shift,
        "debris_velocity": data["orbit_velocity"] + [0.0, 3.0, 4.0],
        "debris_position_sigma": np.full((runs, 470, 3), 2e3),
        "debris_velocity_sigma": np.full((runs, 470, 3), 10.0),
        "attitude_bias": scene.problem(attitude_bias=True)
        .truth(data)[..., 6:]
        .reshape(runs, 470, 2, 3),
        "covariance_time_s": np.array([469.0]),
        "covariance": np.tile(np.diag([4e6] * 3 + [100.0] * 3), (runs, 1, 1, 1)),
    }
    found = scene.problem(attitude_bias=True).assess(data, (0.0, 1.0))
    assert found["position"][1, [449, 450]].tolist() == pytest.approx([0.0, 6e3])
    assert found["far"][:, 469].tolist() == [0.0, 1.0, 1.0]
    assert found["lost"][:, 469].tolist()[::2] == [0.0, 1.0]
    assert found["pixel"][0].max() < 1e-6
    assert 1.0 < found["pixel"][1, 469] < 10.0
    assert found["velocity"][0] == pytest.approx(5.0)
    assert found["position_spread"][0, 0] == pytest.approx(np.sqrt(12e6))
    assert found["covariance_trace"][0, 0] == pytest.approx(12e6 + 300.0)
    assert found["bias_error"].max() < 1e-12
    by_hand = np.array([0.0, 36e6 / 4e6]) + 25.0 / 100.0
    assert found["nees"][:2, 469].tolist() == pytest.approx((by_hand / 6).tolist())
    assert np.isnan(found["nees"][:2, :469]).all()


def test_what_is_taken_for_granted_moves_the_points_as_differences_say(two_observers) -> None:
    scene = two_observers(3)
    problem = scene.problem()
    truth = problem.truth(scene.data)[:, 80]
    found = problem.model(scene.data, scene.CLOCK).doubted(truth, 80)

    def shown(growth: float, turn: np.ndarray) -> np.ndarray:
        """Pixels with a longer focal length and cameras that are turned, both observers alike."""
        known = Rotation.from_quat(scene.data["true_q_ic"].reshape(-1, 4), scalar_first=True)
        true = (known * Rotation.from_rotvec(-turn)).as_quat(scalar_first=True)
        changed = scene.data | {
            "focal_px": scene.data["focal_px"] * (1.0 + growth),
            "known_q_ic": true.reshape(scene.data["true_q_ic"].shape),
        }
        return problem.model(changed, scene.CLOCK).points(truth, 80)

    none, size = np.zeros(3), 1e-6
    focal = (shown(size, none) - shown(-size, none)) / (2.0 * size)
    np.testing.assert_allclose(found[..., 0], focal, rtol=1e-5, atol=1e-3)
    for axis, turn in enumerate(size * np.eye(3)):
        expected = (shown(0.0, turn) - shown(0.0, -turn)) / (2.0 * size)
        for s in range(2):
            own = found[..., 1 + 3 * s + axis]
            np.testing.assert_allclose(own[:, s], expected[:, s], rtol=1e-5, atol=1e-3)
            assert not own[:, 1 - s].any()
