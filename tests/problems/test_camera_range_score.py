"""Scores of made-up estimates: of the truth, of the truth in other axes, of a known error."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.dynamics import kepler, log_inertia
from debrisest.dynamics.relative_motion import hill_frame
from debrisest.problems.camera_range.data import require_measurable
from debrisest.problems.camera_range.score import scored_features, scores
from debrisest.target.start_frame import InStartFrame, in_start_frame

RUNS, EPOCHS, POINTS = 2, 6, 7
ROWS = np.arange(14)


def _truth(seed: int = 0) -> tuple[Data, InStartFrame]:
    rng, times = np.random.default_rng(seed), 5.0 * np.arange(EPOCHS)
    orbit = kepler.propagate(*kepler.state_from_elements(7e6, 0, 1.0, 0.2, 0, 0), times)
    root = rng.standard_normal((RUNS, 3, 3))
    data: Data = {
        "time_s": times,
        "orbit_position": np.stack([orbit[0]] * RUNS),
        "orbit_velocity": np.stack([orbit[1]] * RUNS),
        "true_q_ib": quaternion.normalize(rng.standard_normal((RUNS, EPOCHS, 4))),
        "true_rate_b": rng.standard_normal((RUNS, EPOCHS, 3)),
        "true_point_b": rng.standard_normal((RUNS, POINTS, 3)),
        "true_inertia_b": np.eye(3) + root @ np.swapaxes(root, -1, -2),
        "true_q_hc": quaternion.normalize(rng.standard_normal((RUNS, EPOCHS, 4))),
        "chaser_position_h": rng.standard_normal((RUNS, EPOCHS, 3)),
        "chaser_velocity_h": rng.standard_normal((RUNS, EPOCHS, 3)),
        "measured_pixel": np.zeros((RUNS, EPOCHS, 1, POINTS, 2)),
        "covariance_time_s": times[-1:],
        "covariance": np.tile(1e-4 * np.eye(14), (RUNS, 1, 1, 1)),
    }
    truth = in_start_frame(data, data["true_q_hc"][:, 0])
    data |= {
        "start_relative_position_h": data["chaser_position_h"][:, 0] + [3.0, 0, 4.0],
        "start_relative_velocity_h": data["chaser_velocity_h"][:, 0] + [0, 0.5, 0],
        "start_rate_b": truth.rate[:, 0] + [0, 0, 0.2],
        "start_point_b": truth.point + np.array([0, 0, 1.0]),
        "start_inertia_b": truth.inertia + 2.0 * np.eye(3),
    }
    return data, truth


def _estimate(data: Data, truth: InStartFrame, turn: Array) -> Data:
    """The truth told in body axes that are turned by ``turn (3, 3)``."""
    q_turn = quaternion.from_matrix(turn)
    tensor = turn @ truth.inertia @ turn.T
    points = np.repeat((truth.point @ turn.T)[:, None], EPOCHS, axis=1)
    return data | {
        "relative_position_h": data["chaser_position_h"],
        "relative_velocity_h": data["chaser_velocity_h"],
        "q_hb": quaternion.multiply(truth.q_he, quaternion.conjugate(q_turn)),
        "rate_b": truth.rate @ turn.T,
        "log_inertia": np.repeat(log_inertia.log_ratios(tensor)[:, None], EPOCHS, axis=1),
        "point_b": points,
        "q_hb_sigma": 0.01 * np.ones_like(truth.q_he),
        "point_b_sigma": np.ones_like(points),
    }


def test_the_truth_has_no_error() -> None:
    data, truth = _truth()
    found = scores(_estimate(data, truth, np.eye(3)), "true_q_hc", ROWS)
    names = ["position", "velocity", "rate", "attitude", "points", "inertia", "gauge", "nees"]
    names += ["aligned_rate", "aligned_attitude", "aligned_points", "aligned_inertia"]
    for name in names:
        assert np.nanmax(np.abs(found[name])) < 1e-7, name
    assert np.abs(found["position_remaining"]).max() < 1e-12


def test_other_body_axes_are_an_error_that_alignment_takes_away() -> None:
    data, truth = _truth(1)
    angle = np.radians(2.0)
    turn = quaternion.to_matrix(quaternion.exp(angle * np.array([0.6, 0.0, 0.8])))
    found = scores(_estimate(data, truth, turn), "true_q_hc", ROWS)
    assert np.allclose(found["gauge"], angle)
    assert np.allclose(found["attitude"], angle)
    assert (found["points"] > 1e-3).all()
    assert (found["rate"] > 1e-4).any()
    for name in ("aligned_rate", "aligned_attitude", "aligned_points", "aligned_inertia"):
        assert np.abs(found[name]).max() < 1e-7, name


def test_what_remains_is_told_as_a_part_of_the_first_error() -> None:
    data, truth = _truth(2)
    estimate = _estimate(data, truth, np.eye(3))
    estimate["relative_position_h"] = data["chaser_position_h"] + [0, 0.05, 0]
    estimate["rate_b"] = truth.rate + np.array([0.002, 0, 0])
    estimate["point_b"] = estimate["point_b"] + [0.1, 0, 0]
    found = scores(estimate, "true_q_hc", ROWS)
    assert np.allclose(found["position_remaining"], 0.01)
    assert np.allclose(found["rate_remaining"], 0.01)
    assert np.allclose(found["points_remaining"], 0.1)
    assert np.allclose(found["nees"][:, -1], (0.05**2 + 0.002**2) / 1e-4 / 14)
    assert np.isnan(found["nees"][:, :-1]).all()


def test_a_tensor_is_scored_with_its_scale_and_two_sets_of_points_with_their_disagreement() -> None:
    data, truth = _truth(3)
    estimate = _estimate(data, truth, np.eye(3))
    del estimate["log_inertia"], estimate["q_hb"]
    tensor = truth.inertia + 3.0 * np.eye(3)
    camera = quaternion.multiply(quaternion.conjugate(data["true_q_hc"]), truth.q_he)
    seen = quaternion.rotate(camera[..., None, :], estimate["point_b"])
    seen[..., 2] += np.linalg.norm(data["chaser_position_h"], axis=-1)[..., None]
    estimate |= {
        "inertia_b": np.repeat(tensor[:, None], EPOCHS, axis=1),
        "q_cb": camera,
        "q_cb_sigma": 0.01 * np.ones_like(camera),
        "point_c": seen + np.array([0.0, 0.02, 0.0]),
    }
    found = scores(estimate, "true_q_hc", ROWS[:9])
    assert np.allclose(found["inertia_tensor"], 3.0)
    assert np.allclose(found["inertia_remaining"], 1.5)
    assert np.allclose(found["constraint"], 0.02)
    assert np.allclose(found["attitude"], 0.0, atol=1e-7)
    assert "unobservable_ratios" not in found


def test_points_hardly_ever_seen_are_not_scored() -> None:
    data, truth = _truth(4)
    data["measured_pixel"] = np.zeros((RUNS, EPOCHS, 1, POINTS, 2))
    data["measured_pixel"][..., 2, :] = np.nan
    estimate = _estimate(data, truth, np.eye(3))
    estimate["point_b"][:, :, 2] += 1.0
    estimate["point_b"][:, :3, 4] = np.nan
    assert scored_features(data).sum(-1).tolist() == [POINTS - 1] * RUNS
    assert np.abs(scores(estimate, "true_q_hc", ROWS)["points"]).max() < 1e-12


def test_a_lost_run_has_no_scores_and_spoils_no_other() -> None:
    data, truth = _truth(5)
    estimate = _estimate(data, truth, np.eye(3))
    for name in ("rate_b", "relative_position_h", "log_inertia", "point_b", "q_hb"):
        estimate[name] = estimate[name].copy()
        estimate[name][1, 3:] = np.nan
    found = scores(estimate, "true_q_hc", ROWS)
    for name in ("position", "rate", "points", "inertia", "aligned_rate", "gauge"):
        assert np.isnan(found[name][1, 3:]).all(), name
        assert np.isfinite(found[name][0]).all(), name


def test_measurements_without_a_truth_are_not_scored_and_wrong_ones_are_refused() -> None:
    data, _ = _truth()
    assert scores({"time_s": data["time_s"]}, "true_q_hc", ROWS) == {}
    ranges = np.full((RUNS, EPOCHS), 20.0)
    require_measurable(data | {"measured_range": ranges})
    ranges[1, 3] = 0.0
    with pytest.raises(ValueError, match="range at 15 s is zero"):
        require_measurable(data | {"measured_range": ranges})
    with pytest.raises(ValueError, match="range at 15 s is zero"):
        require_measurable(data | {"landmark_range": ranges}, "landmark_range")
    with pytest.raises(ValueError, match="at least 4 points, 3 were tracked"):
        require_measurable({"measured_pixel": np.zeros((1, 2, 1, 3, 2))})
    blind = data["measured_pixel"].copy()
    blind[1] = np.nan
    with pytest.raises(ValueError, match="no image shows any point"):
        require_measurable(data | {"measured_pixel": blind, "measured_range": ranges})


def test_directions_as_unknown_as_before_are_unobservable() -> None:
    data, truth = _truth(6)
    sigma = 0.1 * np.array([0.01, 0.3, 0.45, 0.6, 1.0])
    data["covariance"] = data["covariance"].copy()
    data["covariance"][:, :, range(9, 14), range(9, 14)] = sigma**2
    estimate = _estimate(data, truth, np.eye(3))
    found = scores(estimate, "true_q_hc", ROWS, log_inertia_sigma=0.1)
    assert found["unobservable_ratios"].tolist() == [2.0] * RUNS
    assert np.allclose(found["ratio_deviation"], 0.045)


@pytest.mark.parametrize("name", ["q_hb", "q_cb"])
def test_the_angles_sigma_is_that_of_attitudes_so_spread(name: str) -> None:
    data, truth = _truth(7)
    estimate, rng = _estimate(data, truth, np.eye(3)), np.random.default_rng(0)
    if name == "q_cb":
        camera = quaternion.conjugate(data["true_q_hc"])
        estimate["q_cb"] = quaternion.multiply(camera, estimate.pop("q_hb"))
    turns = quaternion.exp(0.02 * rng.standard_normal((20_000, 1, 1, 3)))
    drawn = quaternion.multiply(estimate[name], turns)
    estimate[f"{name}_sigma"] = (drawn - estimate[name]).std(axis=0)
    found = scores(estimate, "true_q_hc", ROWS)["attitude_error_sigma"]
    assert found.shape == (RUNS, EPOCHS, 3)
    assert np.allclose(found, 0.02, rtol=0.03)


def test_components_are_those_of_the_errors_and_the_first_guess_has_its_own() -> None:
    data, truth = _truth(3)
    estimate = _estimate(data, truth, np.eye(3))
    off = np.array([0.3, -0.1, 0.2]) * np.linspace(30.0, 1.0, EPOCHS)[:, None]
    estimate["relative_position_h"] = data["chaser_position_h"] + off
    found = scores(estimate, "true_q_hc", ROWS)
    for axis in range(3):
        np.testing.assert_allclose(found[f"position_{axis + 1}"], [off[:, axis]] * RUNS)
    np.testing.assert_allclose(found["guess_position"], 5.0)
    np.testing.assert_allclose(found["guess_inertia_tensor"], 2.0)
    small = np.linalg.norm(off, axis=-1) <= 0.5
    np.testing.assert_allclose(found["position_convergence"], data["time_s"][small][0])
    assert np.all(found["velocity_convergence"] == 0.0)


def test_features_from_the_camera_are_those_that_it_sees() -> None:
    """By matrices of scipy, from inertial axes on."""
    data, truth = _truth(4)
    hill = hill_frame(data["orbit_position"], data["orbit_velocity"])
    exact = np.empty((RUNS, EPOCHS, POINTS, 3))
    for run, k in np.ndindex(RUNS, EPOCHS):
        to_inertial = Rotation.from_quat(data["true_q_ib"][run, k], scalar_first=True)
        camera = Rotation.from_quat(data["true_q_hc"][run, k], scalar_first=True).as_matrix()
        in_hill = to_inertial.apply(data["true_point_b"][run]) @ hill[run, k]
        exact[run, k] = (in_hill - data["chaser_position_h"][run, k]) @ camera
    estimate = _estimate(data, truth, np.eye(3))
    q_ch = quaternion.conjugate(data["true_q_hc"])
    off = exact + np.array([0.0, 0.1, 0.0])
    estimate |= {"q_cb": quaternion.multiply(q_ch, truth.q_he), "point_c": off}
    found = scores(estimate, "true_q_hc", ROWS)
    np.testing.assert_allclose(found["camera_points"], 0.1, atol=1e-9)
    np.testing.assert_allclose(found["first_point_c_2"], 0.1, atol=1e-9)
    assert np.abs(found["first_point_c_1"]).max() < 1e-9
