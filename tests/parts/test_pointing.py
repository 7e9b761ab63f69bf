"""The simulation part of the pointing control: alike and unlike runs, verdicts, wrong input."""

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.spatial.transform import Rotation

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import kepler
from debrisest.parts.sensors.pointing_control import PointingControl

INERTIA = [[1.066e-3, -4e-6, 7e-6], [-4e-6, 1.042e-3, 5e-6], [7e-6, 5e-6, 9.62e-4]]
KEYS = {"kind": "pointing_control", "inertia_kg_m2": INERTIA, "robust_term": "conditional"}


def scene(duration: int, runs: int) -> dict[str, np.ndarray]:
    times, deg = np.arange(float(duration)), np.radians
    start = kepler.state_from_elements(7.493e6, 0.1, deg(20), deg(35), deg(70), deg(8))
    debris = kepler.propagate(*start, times)
    start = kepler.state_from_elements(7.5e6, 0.1, deg(30), deg([10.0, 7.0]), deg(90), deg(8))
    own = [x.swapaxes(0, 1) for x in kepler.propagate(*start, times)]
    names = ("orbit_position", "orbit_velocity", "observer_position", "observer_velocity")
    data = {name: np.stack([x] * runs) for name, x in zip(names, (*debris, *own))}
    image = {"focal_px": np.full(runs, 335.0), "image_half_size": [[240.0, 180.0]] * runs}
    data["observer"] = np.array(["s1", "s2"])
    return {"time_s": times, **data, **{name: np.array(x) for name, x in image.items()}}


def simulate(data: dict[str, np.ndarray], runs: list[int], **keys: object) -> dict:
    part = PointingControl(**KEYS | keys)
    result = part.simulate(data, Clock.regular(len(data["time_s"]), 1.0), Draws(1, "case", runs))
    assert set(result) == set(part.given)
    return result


@pytest.fixture(scope="module")
def alike() -> dict:
    return simulate(scene(50, 3), [0, 1, 2])


def test_runs_that_are_alike_get_the_same(alike) -> None:
    assert alike["section"][:, [24, 25, 42, 43]].tolist() == [[0, 1, 1, 2]] * 3
    assert alike["cameras_at_start"].tolist() == [2, 2, 2]
    assert set(alike["pointing_status"]) == {"in view of every camera at each epoch"}
    np.testing.assert_array_equal(alike["torque"][0], alike["torque"][2])


def test_a_run_does_not_depend_on_those_beside_it(alike) -> None:
    data = scene(50, 3)
    data["orbit_position"][1] += 5e3
    unlike = simulate(data, [0, 1, 2])
    assert np.abs(unlike["true_pixel"][1] - alike["true_pixel"][1]).max() > 0.5
    for name in ("true_pixel", "torque", "true_euler", "section", "settling_time"):
        np.testing.assert_allclose(unlike[name][[0, 2]], alike[name][[0, 2]], atol=1e-9)


def test_white_errors_are_the_runs_own_and_shake_the_torque(alike) -> None:
    keys = {"errors": "white", "switching": {"most_s": 10.0, "hold_s": 2.0}}
    both, alone = simulate(scene(40, 2), [4, 5], **keys), simulate(scene(40, 1), [5], **keys)
    np.testing.assert_array_equal(both["torque"][1], alone["torque"][0])
    assert np.nanmax(np.abs(both["torque"][0] - both["torque"][1])) > 1e-5
    assert np.all(both["total_variation"] > 10 * alike["total_variation"][:2])


def test_attitudes_and_pixels_fit_together(alike) -> None:
    data = scene(50, 1)
    apart = data["orbit_position"][0, :, None] - data["observer_position"][0]
    camera = Rotation.from_quat(alike["true_q_ic"][0].reshape(-1, 4), scalar_first=True)
    x, y, z = camera.inv().apply(apart.reshape(-1, 3)).T
    expected = 335.0 * np.stack([x / z, y / z], axis=-1).reshape(50, 2, 2)
    np.testing.assert_allclose(alike["true_pixel"][0], expected, atol=1e-8)


def test_the_history_has_the_scenarios_times(alike) -> None:
    times, pixel = alike["control_time_s"], alike["control_pixel"][0]
    np.testing.assert_allclose(np.diff(times), 0.5)
    at = np.flatnonzero(np.isclose(times % 1.0, 0.0) & np.isfinite(pixel[:, 0, 0]))
    epochs = np.rint(times[at]).astype(int)
    assert epochs.tolist() == list(range(25, 43))
    np.testing.assert_allclose(pixel[at], alike["true_pixel"][0, epochs], atol=1e-6)
    assert np.nanmax(np.abs(alike["torque"])) == pytest.approx(alike["peak_torque"][0])


def test_printed_axes_are_a_verdict() -> None:
    result = simulate(scene(40, 2), [0, 1], axes="printed")
    assert np.isnan(result["true_pixel"]).all()
    assert not result["section"].any()
    assert result["cameras_at_start"].tolist() == [0, 0]
    assert set(result["pointing_status"]) == {"in view of no camera at any epoch"}
    assert np.isnan(result["peak_torque"]).all()


def test_debris_outside_every_image_at_the_start_is_refused() -> None:
    data = scene(3, 2)
    data["focal_px"][:] = 1e4
    with pytest.raises(ValueError, match="no camera sees the debris at the start"):
        simulate(data, [0, 1])
    assert PointingControl.tried


@pytest.mark.parametrize(
    ("wrong", "word"),
    [
        ({"inertia_kg_m2": [[0.0] * 3] * 3}, "positive principal moments"),
        ({"tracking": {"proportional": [-5.0, 5.0, 1.0, 1.0, 1.0]}}, "greater than 0"),
        ({"holding": {"damping": [0.0, 1.0, 1.0]}}, "greater than 0"),
        ({"gain_error": 1.0}, "less than 1"),
        ({"torque_limit_n_m": 0.0}, "greater than 0"),
        ({"tracking": {"damping": [3.0]}}, "at least 2"),
        ({"switching": {"least_s": 90.0}}, "least_s, 90 s, must not be longer than most_s, 40 s"),
    ],
)
def test_wrong_settings_are_refused(wrong, word) -> None:
    with pytest.raises(ValidationError, match=word):
        PointingControl(**KEYS | wrong)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"margin_px": 300.0}, "margin_px, 300 px, must be less than the camera's half_size_px"),
        ({"margin_px": 180.0}, "margin_px, 180 px, must be less"),
        ({"control_step_s": 1e-9}, "control_step_s, 1e-09 s, must be at most step_s, 1 s"),
        ({"control_step_s": 1e-300}, "must be at most step_s, 1 s, and at least step_s / 10000"),
        ({"control_step_s": 1e300}, "must be at most step_s, 1 s"),
        ({"control_step_s": 1.1}, "must be at most step_s, 1 s"),
    ],
)
def test_what_does_not_fit_the_camera_or_the_clock_is_refused(wrong, said) -> None:
    with pytest.raises(ValueError, match=said):
        simulate(scene(3, 1), [0], **wrong)


@pytest.mark.parametrize(("control_step", "count"), [(1.0, 1), (0.4, 3), (0.02, 50)])
def test_a_step_has_a_whole_number_of_control_steps(control_step, count) -> None:
    result = simulate(scene(3, 1), [0], control_step_s=control_step, store_every=1)
    assert len(result["control_time_s"]) == 3 * count


def test_a_plant_that_is_not_the_model_is_drawn_for_each_run(alike) -> None:
    keys = {"inertia_error": 0.1, "torque_error": 0.1}
    drawn, alone = simulate(scene(50, 3), [0, 1, 2], **keys), simulate(scene(50, 1), [2], **keys)
    np.testing.assert_array_equal(drawn["torque"][2], alone["torque"][0])
    assert len(set(drawn["peak_torque"])) == 3 or len(set(drawn["total_variation"])) == 3
    assert np.all(drawn["gain_mismatch"] > 0.05)
    assert np.all(alike["gain_mismatch"] < 0.05)
    np.testing.assert_allclose(alike["drift_mismatch"], 0.1, atol=0.01)


def test_a_satellite_can_have_its_own_inertia_and_angles(alike) -> None:
    own = {"s2": {"inertia_kg_m2": (2 * np.array(INERTIA)).tolist(), "angles_deg": [0, 2, 0]}}
    unlike = simulate(scene(50, 1), [0], satellites=own)
    np.testing.assert_allclose(np.degrees(unlike["true_euler"][0, 0]), [[0, 0, 0], [0, 2, 0]])
    assert unlike["first_section"][0] != alike["first_section"][0]
    first = [np.nanmax(np.abs(x["torque"][0]), axis=(0, 2)) for x in (unlike, alike)]
    assert first[0][1] > 1.5 * first[1][1]


def test_a_satellite_that_is_none_is_told() -> None:
    with pytest.raises(ValueError, match="no observer is called s3; there are s1, s2"):
        simulate(scene(50, 1), [0], satellites={"s3": {"angles_deg": [0.0, 1.0, 0.0]}})


def test_the_debris_is_brought_to_the_pixel_that_is_desired() -> None:
    data = simulate(scene(60, 1), [0], desired_px=[50.0, -30.0])
    pixel = data["control_pixel"][0]
    near = np.abs(pixel - [50.0, -30.0]).max(axis=-1) < 5.0
    assert np.all(near.any(axis=0))
    assert np.isfinite(data["settling_time"]).all()
