"""Chaser on an ellipse, camera and range finder, first guess: against geometry and statistics."""

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from debrisest.arrays import Data
from debrisest.attitude import quaternion
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics.relative_motion import hill_frame
from debrisest.parts.sensors.camera_range import CameraRange
from debrisest.parts.starts.drawn_shape import DrawnShape
from debrisest.parts.starts.guess import Guess
from debrisest.parts.truth.closed_ellipse import ClosedEllipse
from debrisest.parts.truth.kepler_orbit import KeplerOrbit
from debrisest.parts.truth.random_box import RandomBox
from debrisest.parts.truth.random_tumble import RandomTumble
from debrisest.parts.truth.rigid_points import Feature, RigidPoints
from debrisest.parts.truth.torque_free import TorqueFree

CLOCK = Clock.regular(300.0, 5.0)
PLACE, SPEED = [5.0, 17.3205081, 5.90884652], [9.3358198e-3, -1.078007613e-2, -1.12316e-3]
CORNERS = {
    f"{x}{y}{z}": [x * 1.0, y * 0.75, z * 0.5] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)
}


def _camera(**keys: Any) -> CameraRange:
    return CameraRange(kind="camera_range", **keys)


def _scene(
    runs: int = 3, points: dict[str, list[float]] = CORNERS, seed: int = 0
) -> tuple[Data, Draws]:
    draws = Draws(seed, "case", range(runs))
    features = {name: Feature(position_m=p, normal=p) for name, p in points.items()}
    parts = [
        RigidPoints(kind="rigid_points", inertia_kg_m2=[135.4, 208.3, 260.4], points=features),
        KeplerOrbit(kind="kepler", semi_major_axis_km=7000.0, inclination_deg=98.0),
        TorqueFree(kind="torque_free", rate_deg_s=[0.6, 0.4, 1.0]),
        ClosedEllipse(kind="closed_ellipse", position_m=PLACE, velocity_m_s=SPEED),
    ]
    data: Data = {"time_s": CLOCK.times}
    for part in parts:
        data |= part.simulate(data, CLOCK, draws)
    return data, draws


def _seen(keys: dict[str, Any], runs: int = 3, seed: int = 0) -> Data:
    data, draws = _scene(runs, seed=seed)
    return data | _camera(**keys).simulate(data, CLOCK, draws)


def test_pixels_are_those_of_points_placed_in_inertial_space() -> None:
    data = _seen({"pixel_noise_px": 1e-9, "whole_pixels": False})
    frame = hill_frame(data["orbit_position"], data["orbit_velocity"])
    chaser = (frame @ data["chaser_position_h"][..., None])[..., 0]
    points = quaternion.rotate(data["true_q_ib"][..., None, :], data["true_point_b"][:, None])
    to_camera = np.swapaxes(frame @ quaternion.to_matrix(data["true_q_hc"]), -1, -2)
    sight = (points - chaser[..., None, :]) @ np.swapaxes(to_camera, -1, -2)
    assert np.allclose(
        data["measured_pixel"][:, :, 0], 1000 * sight[..., :2] / sight[..., 2:], atol=1e-6
    )
    assert np.allclose((to_camera @ chaser[..., None])[..., :2, 0], 0, atol=1e-9)


def test_noise_is_what_it_is_said_to_be() -> None:
    exact = _seen({"pixel_noise_px": 1e-9, "whole_pixels": False, "range_noise_m": 1e-9}, 20)
    noisy = _seen({"attitude_noise_deg": 0.02}, 20)
    error = noisy["measured_pixel"][:, :, 0] - exact["measured_pixel"][:, :, 0]
    assert error.std() == pytest.approx(noisy["pixel_noise"][0], rel=0.03)
    assert noisy["pixel_noise"][0] == pytest.approx(np.sqrt(1 + 1 / 12))
    assert (noisy["measured_pixel"][:, :, 0] == np.round(noisy["measured_pixel"][:, :, 0])).all()
    spread = (noisy["measured_range"] - exact["measured_range"]).std()
    assert spread == pytest.approx(noisy["range_noise"][0], rel=0.1)
    turn = quaternion.angle_between(noisy["true_q_hc"], noisy["known_q_hc"])
    assert np.sqrt(np.mean(turn**2) / 3) == pytest.approx(np.radians(0.02), rel=0.1)


def test_a_bias_is_constant_and_differs_from_run_to_run() -> None:
    data = _seen({"attitude_bias_deg": 0.02})
    turn = quaternion.log(
        quaternion.multiply(quaternion.conjugate(data["true_q_hc"]), data["known_q_hc"])
    )
    assert np.allclose(turn, turn[:, :1], atol=1e-12)
    assert np.abs(turn[0, 0] - turn[1, 0]).max() > 1e-6


def test_lost_tracks_return_and_false_matches_are_anywhere() -> None:
    exact = _seen({"pixel_noise_px": 1e-9, "whole_pixels": False}, 10)["measured_pixel"][:, :, 0]
    data = _seen({"missing_share": 0.2, "false_match_share": 0.1}, 10)["measured_pixel"][:, :, 0]
    seen = np.isfinite(data[..., 0])
    assert seen.mean() == pytest.approx(0.8, abs=0.02)
    assert (np.diff(seen.astype(int), axis=1) == 1).any()
    far = np.linalg.norm(data - exact, axis=-1)[seen] > 8
    assert far.mean() == pytest.approx(0.1, abs=0.02)
    assert np.nanmax(np.abs(data)) <= 200


@pytest.mark.parametrize("visibility", ["box", "back_face"])
def test_hidden_points_have_no_pixels(visibility: str) -> None:
    keys: dict[str, Any] = {"visibility": visibility, "half_sides_m": [1.0, 0.75, 0.5]}
    seen = np.isfinite(_seen(keys)["measured_pixel"][:, :, 0]).all(-1)
    assert 0.2 < seen.mean() < 0.95
    assert seen.sum(-1).max() == (7 if visibility == "box" else 4)


def test_a_range_to_the_surface_is_nearer_and_to_a_landmark_that_landmarks() -> None:
    keys = {"range_noise_m": 1e-9, "half_sides_m": [1.0, 0.75, 0.5]}
    data = _seen(keys | {"range_to": "surface"})
    distance = np.linalg.norm(data["chaser_position_h"], axis=-1)
    depth = distance - data["measured_range"]
    assert depth.min() >= 0.5 - 1e-6
    assert depth.max() <= np.linalg.norm([1.0, 0.75, 0.5]) + 1e-6
    hull = _seen({"range_noise_m": 1e-9, "range_to": "surface"})
    assert np.allclose(hull["measured_range"], data["measured_range"], atol=1e-6)
    points = quaternion.rotate(data["true_q_ib"][..., None, :], data["true_point_b"][:, None])
    frame = hill_frame(data["orbit_position"], data["orbit_velocity"])
    chaser = (frame @ data["chaser_position_h"][..., None])[..., 0]
    away = np.linalg.norm(points - chaser[..., None, :], axis=-1)
    chosen = np.take_along_axis(away, data["landmark"].astype(int)[..., None], axis=-1)[..., 0]
    assert np.allclose(data["landmark_range"], chosen, atol=1e-6)
    assert (chosen < distance).all()


def test_the_range_finder_is_held_on_a_point_that_the_camera_sees() -> None:
    keys = {"visibility": "box", "half_sides_m": [1.0, 0.75, 0.5], "missing_share": 0.6}
    data = _seen(keys | {"range_noise_m": 1e-9}, 6)
    seen = np.isfinite(data["measured_pixel"][:, :, 0]).all(-1)
    ranged = np.isfinite(data["landmark_range"])
    assert 0.02 < 1 - ranged.mean() < 0.9
    assert np.array_equal(ranged, seen.any(-1))
    assert np.array_equal(ranged, np.isfinite(data["landmark"]))
    run, time = np.nonzero(ranged)
    point = data["landmark"][ranged].astype(int)
    assert seen[run, time, point].all()
    frame = hill_frame(data["orbit_position"], data["orbit_velocity"])
    chaser = (frame @ data["chaser_position_h"][..., None])[..., 0]
    placed = quaternion.rotate(data["true_q_ib"][..., None, :], data["true_point_b"][:, None])
    away = np.linalg.norm(placed[run, time, point] - chaser[run, time], axis=-1)
    assert np.allclose(data["landmark_range"][ranged], away, atol=1e-6)


def test_the_guess_lies_on_the_measured_range_and_on_a_plane() -> None:
    data, draws = _scene(400)
    data |= _camera().simulate(data, CLOCK, draws)
    data |= DrawnShape(kind="drawn_shape").simulate(data, CLOCK, draws)
    position = data["start_relative_position_h"]
    assert np.allclose(np.linalg.norm(position, axis=-1), data["measured_range"][:, 0])
    depth = np.broadcast_to(data["measured_range"][:, :1], data["start_point_c"].shape[:2])
    assert np.allclose(data["start_point_c"][..., 2], depth)
    assert np.allclose(data["start_point_b"][..., 2], 0)
    shown = 1000 * data["start_point_c"][..., :2] / data["start_point_c"][..., 2:]
    assert np.allclose(shown, data["measured_pixel"][:, :, 0][:, 0])
    assert not data["start_relative_velocity_h"].any()
    spread = data["start_rate_b"].std(axis=0)
    assert np.allclose(spread, np.radians(0.3), rtol=0.15)
    tensor = data["start_inertia_b"]
    assert np.allclose(tensor, np.swapaxes(tensor, -1, -2))
    assert np.allclose((tensor - tensor.mean(axis=0)).std(axis=0), 1.0, rtol=0.15)


def test_the_rate_of_the_guess_is_told_in_the_cameras_first_axes() -> None:
    data, draws = _scene(1)
    data |= _camera().simulate(data, CLOCK, draws)
    guess = DrawnShape(kind="drawn_shape", rate_sigma_deg_s=1e-9)
    data |= guess.simulate(data, CLOCK, draws)
    frame = hill_frame(data["orbit_position"], data["orbit_velocity"])[0, 0]
    in_space = frame @ quaternion.rotate(data["true_q_hc"][0, 0], data["start_rate_b"][0])
    true = quaternion.rotate(data["true_q_ib"][0, 0], data["true_rate_b"][0, 0])
    assert np.allclose(in_space, true, atol=1e-9)
    started, variance = Guess(kind="guess").start(data, CLOCK)
    assert np.array_equal(started["rate_b"], data["start_rate_b"])
    assert np.array_equal(variance["point_c"], data["start_point_c_sigma"] ** 2)


def test_random_boxes_and_tumbles_differ_and_keep_their_limits() -> None:
    draws, data = Draws(0, "case", range(6)), {"time_s": CLOCK.times}
    data |= RandomBox(kind="random_box", count=9, half_side_m=[0.4, 1.3]).simulate(
        data, CLOCK, draws
    )
    data |= KeplerOrbit(kind="kepler", semi_major_axis_km=7000.0).simulate(data, CLOCK, draws)
    tumbling = RandomTumble(kind="random_tumble", rate_deg_s=[0.05, 0.14])
    data |= tumbling.simulate(data, CLOCK, draws)
    moments = np.diagonal(data["true_inertia_b"], 0, -2, -1)
    half = np.sqrt((moments.sum(-1, keepdims=True) / 2 - moments) * 3 / 500)
    assert ((half > 0.4) & (half < 1.3)).all()
    assert (np.abs(data["true_point_b"]) <= half[:, None]).all()
    rates = np.degrees(np.linalg.norm(data["true_rate_b"][:, 0], axis=-1))
    assert ((rates >= 0.05) & (rates <= 0.14)).all()
    assert len(np.unique(rates)) == 6
    turned = quaternion.angle_between(data["true_q_ib"][:, 0], data["true_q_ib"][:, -1])
    assert np.allclose(np.degrees(turned), rates * 295, rtol=0.2)


def test_bad_input_is_refused_in_words() -> None:
    data, draws = _scene(1)
    with pytest.raises(ValueError, match="range is zero"):
        ClosedEllipse(kind="closed_ellipse", position_m=[0.0, 0.0, 0.0], velocity_m_s=SPEED)
    opened = ClosedEllipse(kind="closed_ellipse", position_m=PLACE, velocity_m_s=[0.0, 0.0, 0.0])
    with pytest.raises(ValueError, match=r"open: .*needs -0\.01078"):
        opened.simulate(data, CLOCK, draws)
    three, _ = _scene(1, dict(list(CORNERS.items())[:3]))
    with pytest.raises(ValueError, match="at least 4 points, the target has 3"):
        _camera().simulate(three, CLOCK, draws)
    near = data | {"chaser_position_h": 0.02 * data["chaser_position_h"]}
    with pytest.raises(ValueError, match="is behind the camera at 0 s"):
        _camera().simulate(near, CLOCK, draws)
    with pytest.raises(ValidationError, match="half_sides_m"):
        _camera(visibility="box")
    with pytest.raises(ValueError, match="lower limit comes first"):
        RandomTumble(kind="random_tumble", rate_deg_s=[0.14, 0.05])
    with pytest.raises(ValueError, match="lower limit comes first"):
        RandomBox(kind="random_box", count=4, half_side_m=[1.0, 0.5])
    with pytest.raises(ValidationError, match="greater than 0"):
        RandomBox(kind="random_box", count=4, half_side_m=[0.0, 0.5])


def test_a_range_from_inside_the_target_is_refused() -> None:
    sides = [(0.1, 0.1), (-0.1, 0.1), (0.1, -0.1), (-0.1, -0.1)]
    data, draws = _scene(1, {f"p{i}": [x, y, 0.01] for i, (x, y) in enumerate(sides)})
    data = data | {"chaser_position_h": 0.05 * data["chaser_position_h"]}
    camera = _camera(range_to="surface", half_sides_m=[30.0, 30.0, 30.0])
    with pytest.raises(ValueError, match="range is zero or below"):
        camera.simulate(data, CLOCK, draws)


def test_in_the_shadow_the_camera_shows_nothing_and_the_range_goes_on() -> None:
    data = _seen({"dark_s": [[100, 150], [140, 200]]})
    seen = np.isfinite(data["measured_pixel"]).all(axis=(2, 3, 4))
    lit = (CLOCK.times < 100) | (CLOCK.times >= 200)
    assert (seen == lit).all()
    assert np.isfinite(data["measured_range"]).all()


def test_points_outside_the_image_are_not_seen() -> None:
    free, limited = _seen({}), _seen({"half_size_px": [60, 40]})
    inside = np.all(np.abs(free["measured_pixel"]) <= [60.5, 40.5], axis=-1)
    seen = np.isfinite(limited["measured_pixel"]).all(axis=-1)
    assert 0.05 < seen.mean() < 0.95
    assert not (seen & ~inside).any()
    well_inside = np.all(np.abs(free["measured_pixel"]) <= [59, 39], axis=-1)
    assert not (well_inside & ~seen).any()
