"""Satellites, their cameras and what these show of a piece of debris."""

from collections.abc import Callable

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import kepler
from debrisest.parts.sensors.attitude_knowledge import AttitudeKnowledge
from debrisest.parts.sensors.detections import Detections
from debrisest.parts.sensors.pinhole_camera import PinholeCamera
from debrisest.parts.starts.drawn_orbit import DrawnOrbit
from debrisest.parts.truth.kepler_orbit import KeplerOrbit
from debrisest.parts.truth.perturbed_orbit import PerturbedOrbit
from debrisest.parts.truth.satellite import Satellite
from debrisest.sensors.detections import unlabelled

DEBRIS = {
    "semi_major_axis_km": 7493.0,
    "eccentricity": 0.1,
    "inclination_deg": 20.0,
    "raan_deg": 35.0,
    "argument_of_periapsis_deg": 70.0,
    "true_anomaly_deg": 8.0,
}
OWN = DEBRIS | {
    "semi_major_axis_km": 7500.0,
    "inclination_deg": 30.0,
    "argument_of_periapsis_deg": 90.0,
}
HALF = np.array([240.0, 180.0])
CLOCK = Clock.regular(60.0, 1.0)


def draws(runs: int, seed: int = 1) -> Draws:
    return Draws(seed, "case", list(range(runs)))


@pytest.fixture(scope="module")
def scene() -> Callable[..., Data]:
    """Two satellites whose cameras look at the debris, a few degrees beside it."""

    def make(runs: int = 30) -> Data:
        data: Data = {"time_s": CLOCK.times}
        drawn = draws(runs)
        data |= PerturbedOrbit(kind="perturbed", **DEBRIS).simulate(data, CLOCK, drawn)
        for name, node in (("one", 10.0), ("two", 7.0)):
            own = Satellite(kind="satellite", **OWN | {"raan_deg": node})
            data |= own.simulate_named(name, data, CLOCK, drawn)
        camera = PinholeCamera(kind="pinhole_camera", focal_px=335.0, half_size_px=HALF.tolist())
        data |= camera.simulate(data, CLOCK, drawn)
        away = data["orbit_position"][0, :, None] - data["observer_position"][0]
        turns, aside = [], Rotation.from_rotvec([0.05, 0.1, 0.0])
        for line in away.reshape(-1, 3):
            boresight = line / np.linalg.norm(line)
            side = np.cross([0.0, 0.0, 1.0], boresight)
            side /= np.linalg.norm(side)
            axes = np.stack([side, np.cross(boresight, side), boresight], axis=-1)
            turns.append((Rotation.from_matrix(axes) * aside).as_quat(scalar_first=True))
        q_ic = np.array(turns).reshape(1, len(CLOCK.times), 2, 4)
        point = np.array(
            [
                Rotation.from_quat(q, scalar_first=True).inv().apply(line)
                for q, line in zip(np.array(turns), away.reshape(-1, 3))
            ]
        ).reshape(1, len(CLOCK.times), 2, 3)
        pixel = 335.0 * point[..., :2] / point[..., 2:]
        assert (np.abs(pixel) < HALF - 40).all()
        data["true_q_ic"] = np.repeat(q_ic, runs, axis=0)
        data["true_pixel"] = np.repeat(pixel, runs, axis=0)
        return data

    return make


def test_satellites_stand_side_by_side_in_the_order_of_the_scenario(scene) -> None:
    data = scene(3)
    assert data["observer"].tolist() == ["one", "two"]
    assert data["observer_position"].shape == (3, 60, 2, 3)
    angles = np.radians([30.0, 7.0, 90.0, 8.0])
    alone = kepler.propagate(*kepler.state_from_elements(7.5e6, 0.1, *angles), CLOCK.times)
    np.testing.assert_array_equal(data["observer_position"][2, :, 1], alone[0])
    np.testing.assert_array_equal(data["observer_velocity"][2, :, 1], alone[1])


def test_a_third_satellite_leaves_the_others_alone(scene) -> None:
    data = scene(2)
    third = Satellite(kind="satellite", **OWN | {"raan_deg": 5.0}, j2=True)
    more = third.simulate_named("three", data, CLOCK, draws(2))
    assert more["observer"].tolist() == ["one", "two", "three"]
    np.testing.assert_array_equal(more["observer_position"][:, :, :2], data["observer_position"])
    plain = Satellite(kind="satellite", **OWN | {"raan_deg": 5.0}).simulate({}, CLOCK, draws(2))
    shift = more["observer_position"][:, :, 2] - plain["observer_position"][:, :, 0]
    fallen = np.linalg.norm(shift[0, -1])
    assert 2.0 < fallen < 60.0  # J2 is some 1e-2 m/s^2 here: 0.5 a t^2 is some 20 m


def test_an_orbit_without_perturbation_is_keplers() -> None:
    alike = [
        part.simulate({}, CLOCK, draws(2))["orbit_position"]
        for part in (
            KeplerOrbit(kind="kepler", **DEBRIS),
            PerturbedOrbit(kind="perturbed", **DEBRIS),
        )
    ]
    np.testing.assert_array_equal(*alike)


def test_each_run_has_its_own_accelerations() -> None:
    noisy = PerturbedOrbit(kind="perturbed", **DEBRIS, acceleration_noise_m_s2=0.1)
    quiet = PerturbedOrbit(kind="perturbed", **DEBRIS).simulate({}, CLOCK, draws(1))
    runs = 400
    found = noisy.simulate({}, CLOCK, draws(runs))
    np.testing.assert_array_equal(
        found["orbit_velocity"][:, 0], quiet["orbit_velocity"][0][[0] * runs]
    )
    moved = found["orbit_velocity"] - quiet["orbit_velocity"]
    assert moved[:, 1].std() == pytest.approx(0.1, rel=0.1)
    assert moved[:, -1].std() == pytest.approx(0.1 * np.sqrt(59), rel=0.1)
    again = noisy.simulate({}, CLOCK, Draws(1, "case", [7]))
    np.testing.assert_array_equal(again["orbit_position"][0], found["orbit_position"][7])


def test_an_attitude_error_is_constant_in_camera_axes(scene) -> None:
    data, runs = scene(500), 500
    part = AttitudeKnowledge(kind="attitude_knowledge", bias_mrad=3.0)
    found = part.simulate(data, CLOCK, draws(runs))

    def turns(q: np.ndarray) -> Rotation:
        return Rotation.from_quat(q[:, [0, -1]].reshape(-1, 4), scalar_first=True)

    bias = (turns(data["true_q_ic"]).inv() * turns(found["known_q_ic"])).as_rotvec()
    bias = bias.reshape(runs, 2, 2, 3)
    np.testing.assert_allclose(bias[:, 0], bias[:, 1], atol=1e-12)
    assert bias[:, 0].std() == pytest.approx(3e-3, rel=0.06)
    assert np.abs(np.corrcoef(bias[:, 0].reshape(runs, 6).T) - np.eye(6)).max() < 0.25
    assert (found["start_attitude_bias"] == 0).all()
    assert (found["start_attitude_bias_sigma"] == 3e-3).all()


def test_without_an_error_the_attitude_is_known(scene) -> None:
    data = scene(2)
    known = AttitudeKnowledge(kind="attitude_knowledge").simulate(data, CLOCK, draws(2))
    np.testing.assert_allclose(known["known_q_ic"], data["true_q_ic"], atol=1e-15)


def test_the_guess_is_drawn_about_the_truth(scene) -> None:
    data = scene(800)
    part = DrawnOrbit(kind="drawn_orbit", position_sigma_m=100.0, velocity_sigma_m_s=20.0)
    found = part.simulate(data, CLOCK, draws(800))
    for name, sigma in (("position", 100.0), ("velocity", 20.0)):
        error = found[f"start_orbit_{name}"] - data[f"orbit_{name}"][:, 0]
        assert error.std() == pytest.approx(sigma, rel=0.08)
        assert np.abs(error.mean(0)).max() < 5 * sigma / np.sqrt(800)
        assert (found[f"start_orbit_{name}_sigma"] == sigma).all()


def detected(data: Data, runs: int, **keys: object) -> Data:
    part = Detections(kind="detections", **keys)
    return part.simulate(data, CLOCK, draws(runs))


def own_points(found: Data) -> np.ndarray:
    """The debris' own detections, NaN where missed."""
    place = found["target_detection"].astype(int)
    chosen = np.take_along_axis(
        found["measured_pixel"], np.maximum(place, 0)[..., None, None], axis=-2
    )[..., 0, :]
    return np.where(place[..., None] >= 0, chosen, np.nan)


def test_own_points_are_rounded_and_have_the_noise_of_both(scene) -> None:
    data = scene()
    found = detected(data, 30, pixel_noise_px=1.0, clutter={"count": 2, "half_width_px": 10.0})
    assert found["measured_pixel"].shape == (30, 60, 2, 3, 2)
    assert np.isfinite(found["measured_pixel"]).all()
    assert (found["measured_pixel"] == np.round(found["measured_pixel"])).all()
    error = own_points(found) - data["true_pixel"]
    assert error.var() == pytest.approx(1 + 1 / 12, rel=0.07)
    assert abs(error.mean()) < 0.06


def test_every_place_in_the_list_is_as_likely(scene) -> None:
    found = detected(scene(), 30, clutter={"count": 3, "half_width_px": 10.0})
    counts = np.bincount(found["target_detection"].astype(int).ravel(), minlength=4)
    trials = counts.sum()
    assert np.abs(counts - trials / 4).max() < 5 * np.sqrt(trials * 3 / 16)


def test_clutter_is_spread_evenly_over_the_square(scene) -> None:
    data = scene()
    found = detected(data, 30, whole_pixels=False, clutter={"count": 1, "half_width_px": 10.0})
    place = 1 - found["target_detection"].astype(int)
    clutter = np.take_along_axis(found["measured_pixel"], place[..., None, None], -2)[..., 0, :]
    offset = clutter - data["true_pixel"]
    assert 9.9 < np.abs(offset).max() < 10.0
    assert offset.std() == pytest.approx(10 / np.sqrt(3), rel=0.03)
    assert abs(np.corrcoef(offset.reshape(-1, 2).T)[0, 1]) < 0.08


def test_a_missed_detection_leaves_no_point(scene) -> None:
    found = detected(scene(), 30, missing_share=0.3)
    missed = found["target_detection"] == -1
    assert missed.mean() == pytest.approx(0.3, abs=0.04)
    assert np.isnan(found["measured_pixel"][missed]).all()
    assert np.isfinite(found["measured_pixel"][~missed]).all()


def test_what_is_out_of_view_shows_nothing_and_images_end_at_their_border(scene) -> None:
    data = scene()
    data["true_pixel"] = data["true_pixel"].copy()
    data["true_pixel"][:, :30] = np.nan
    data["true_pixel"][:, 30:] = [239.0, -179.0]
    found = detected(data, 30, clutter={"count": 4, "half_width_px": 20.0})["measured_pixel"]
    assert np.isnan(found[:, :30]).all()
    seen = found[:, 30:]
    assert (np.abs(seen[np.isfinite(seen).all(-1)]) <= HALF).all()
    assert 0.05 < np.isnan(seen[..., 0]).mean() < 0.9
    first_nan = np.isnan(seen[..., 0]).argmax(-1)
    count = np.isfinite(seen[..., 0]).sum(-1)
    assert (first_nan[count < 5] == count[count < 5]).all()


def test_companions_fly_beside_the_debris_for_good(scene) -> None:
    data, runs = scene(200), 200
    keys = {"count": 2, "spread_km": 10.0, "relative_speed_m_s": 10.0}
    found = detected(data, runs, pixel_noise_px=0.0, whole_pixels=False, companions=keys)
    guess = found["start_companion_position"] - data["orbit_position"][:, 0, None]
    assert guess.shape == (runs, 2, 3)
    assert guess.std() == pytest.approx(np.sqrt(2) * 1e4, rel=0.12)
    assert (found["start_companion_position_sigma"] == 1e4).all()
    speed = found["start_companion_velocity"] - data["orbit_velocity"][:, 0, None]
    assert speed.std() == pytest.approx(np.hypot(10.0, 100.0), rel=0.12)
    points = found["measured_pixel"]
    distance = np.linalg.norm(points - data["true_pixel"][..., None, :], axis=-1)
    away = np.sort(distance, axis=-1)
    assert away[..., 0].max() < 1e-9
    nearest = away[:, :, 0, 1]
    assert np.median(nearest[:, 0]) < 8.0
    steps = np.abs(np.diff(nearest, axis=1))
    assert np.nanmax(steps) < 0.2  # no jump from frame to frame, unlike clutter


@pytest.mark.parametrize("noise", [0.0, 0.01])
def test_companions_fall_as_the_debris_does(scene, noise: float) -> None:
    """From the very place of the debris, at its velocity, they show its own pixels."""
    data, near = scene(2), {"spread_km": 1e-9, "relative_speed_m_s": 0.0}
    orbit = {"kind": "perturbed", **DEBRIS, "j2": True, "acceleration_noise_m_s2": noise}
    data |= PerturbedOrbit(**orbit).simulate({}, CLOCK, draws(2))
    away = data["orbit_position"][:, :, None] - data["observer_position"]
    turn = Rotation.from_quat(data["true_q_ic"].reshape(-1, 4), scalar_first=True)
    point = turn.inv().apply(away.reshape(-1, 3)).reshape(away.shape)
    data["true_pixel"] = 335.0 * point[..., :2] / point[..., 2:]
    keys = {"pixel_noise_px": 0.0, "whole_pixels": False}
    found = detected(data, 2, **keys, companions={"count": 1, "j2": True, **near})
    apart = np.ptp(found["measured_pixel"], axis=-2)
    assert np.max(apart[:, :2] if noise else apart) < 1e-6 + 1e-4 * (noise > 0)


@pytest.mark.parametrize("j2", [False, True])
def test_companions_under_another_gravity_are_refused(scene, j2: bool) -> None:
    data = scene(1)
    orbit = PerturbedOrbit(kind="perturbed", **DEBRIS, j2=j2).simulate({}, CLOCK, draws(1))
    keys = {"count": 1, "spread_km": 1.0}
    detected(data | orbit, 1, companions=keys | {"j2": j2})
    with pytest.raises(ValueError, match=f"set companions.j2 to {str(j2).lower()}"):
        detected(data | orbit, 1, companions=keys | {"j2": not j2})


def test_the_points_of_a_run_do_not_depend_on_its_companions(scene) -> None:
    keys = {"clutter": {"count": 2, "half_width_px": 10.0}, "missing_share": 0.1}
    many = detected(scene(5), 5, **keys)
    part = Detections(kind="detections", **keys)
    alone = part.simulate(scene(1), CLOCK, Draws(1, "case", [3]))
    np.testing.assert_array_equal(many["measured_pixel"][3], alone["measured_pixel"][0])
    np.testing.assert_array_equal(many["target_detection"][3], alone["target_detection"][0])


def test_unlabelled_points_keep_who_they_are() -> None:
    rng = np.random.default_rng(5)
    points = rng.normal(size=(50, 4, 2))
    points[rng.random((50, 4)) < 0.4] = np.nan
    shuffled, place = unlabelled(points, rng.random((50, 4)))
    for before, after, k in zip(points, shuffled, place):
        seen = np.isfinite(before[:, 0])
        np.testing.assert_array_equal(np.isfinite(after[:, 0]), np.arange(4) < seen.sum())
        assert sorted(after[: seen.sum(), 0]) == sorted(before[seen, 0])
        assert (k == -1) == (not seen[0])
        if k >= 0:
            np.testing.assert_array_equal(after[k], before[0])


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"missing_share": -0.5}, "greater than or equal to 0"),
        ({"missing_share": 1.0}, "less than 1"),
        ({"pixel_noise_px": -1.0}, "greater than or equal to 0"),
        ({"clutter": {"count": 0, "half_width_px": 10.0}}, "greater than or equal to 1"),
    ],
)
def test_wrong_numbers_are_refused(keys: dict, said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Detections(kind="detections", **keys)


def test_an_orbit_below_the_ground_is_refused() -> None:
    with pytest.raises(ValidationError, match="below its surface"):
        Satellite(kind="satellite", semi_major_axis_km=6000.0)
