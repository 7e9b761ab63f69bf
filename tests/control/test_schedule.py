"""Geometry and schedule of the paper's scenario against the figures of an independent prototype."""

from dataclasses import replace

import numpy as np
import pytest

from debrisest.control.metrics import section_metrics


def lengths(section: np.ndarray) -> list[tuple[int, int]]:
    """First epoch and length of each section."""
    return [(int(np.argmax(section == n)), int((section == n).sum())) for n in np.unique(section)]


def test_ranges_and_pixels_at_the_start(mission, track) -> None:
    ranges = np.linalg.norm(track(1).point_o[0, 0], axis=-1) / 1e3
    assert ranges == pytest.approx([1235.97, 1355.30], abs=0.02)
    expected = np.array([[125.2, -34.7], [228.9, -42.8]])
    np.testing.assert_allclose(mission.pixel[0, 0], expected, atol=0.1)


def test_the_second_satellite_starts_the_first_turn_at_25_s(mission) -> None:
    (start, e1), (c1, length), (e2, _), (c2, _), *_ = lengths(mission.section[0])
    assert (start, e1, c1) == (0, 25, 25)
    assert e2 == c1 + length
    assert length == pytest.approx(41, abs=1)
    assert c2 == pytest.approx(470, abs=3)
    edge = 240.0 - np.abs(mission.pixel[0, :, :, 0])
    assert edge[c1, 1] < 2.5 < edge[c1 - 1, 1]
    assert edge[c1, 0] > 100.0


def test_turning_brings_the_debris_to_the_middle_and_then_it_drifts(mission) -> None:
    end = np.argmax(mission.section[0] == 2)
    assert np.abs(mission.pixel[0, end]).max() < 5.0
    yaw = np.degrees(mission.angles[0, end])
    np.testing.assert_allclose(yaw, [[5.4, -0.9, 21.8], [5.8, -1.7, 36.5]], atol=0.2)
    assert np.abs(mission.pixel[0, end + 100]).max() > 10.0


def test_attitudes_stand_still_in_estimation_sections(mission) -> None:
    section, angles = mission.section[0], mission.angles[0]
    estimating = (section[:-1] % 2 == 0) & (section[1:] == section[:-1])
    np.testing.assert_array_equal(np.diff(angles, axis=0)[estimating], 0.0)
    assert np.isnan(mission.torque[0, section % 2 == 0]).all()
    assert np.isfinite(mission.torque[0, :-1][section[:-1] % 2 == 1]).all()


@pytest.mark.parametrize(("frozen", "leaves"), [("local", 32), ("inertial", 38)])
def test_a_camera_at_rest_among_the_stars_loses_the_debris_later(fly, frozen, leaves) -> None:
    pointing = fly(leaves + 1, margin=0.0, rounded=False, frozen=frozen)
    assert np.argmax(pointing.section[0] == 1) == leaves


def test_with_the_orbital_rate_the_body_turns_to_hold_local_axes(fly) -> None:
    pointing = fly(48, turning=True, reading="conditional")
    held = pointing.rate_b[0, pointing.section[0] == 1][-1, -1]
    assert np.linalg.norm(held, axis=-1) == pytest.approx([1.19e-3] * 2, rel=0.05)
    still = fly(48, turning=False, reading="conditional")
    settled = np.argmax(pointing.section[0] == 2)
    np.testing.assert_allclose(pointing.pixel[0, settled], still.pixel[0, settled], atol=2.0)


def test_local_axes_are_held_from_the_first_control_step_on(fly) -> None:
    """Without torque: the body has turned with the axes all along."""
    pointing = fly(28, turning=True, torque_limit=1e-15)
    assert pointing.section[0, [24, 25, 27]].tolist() == [0, 1, 1]
    np.testing.assert_allclose(pointing.angles[0, 25:], 0.0, atol=1e-5)
    among_the_stars = fly(39, turning=True, torque_limit=1e-15, frozen="inertial")
    first = np.argmax(among_the_stars.section[0] == 1)
    moved = np.diff(among_the_stars.angles[0], axis=0)[[first - 1, first]]
    np.testing.assert_allclose(moved[1], moved[0], atol=1e-5)
    assert np.abs(moved).max(-1).min() > 1e-3


def test_debris_that_no_camera_sees_is_left_alone(closed_loop, track) -> None:
    behind = replace(closed_loop(40), track=track(40, "printed"))
    assert not behind.in_view(np.zeros((1, 2, 3))).any()
    pointing = behind.run(np.zeros((1, 2, 3)))
    assert np.isnan(pointing.pixel).all()
    assert not pointing.section.any()


def test_a_third_satellite_and_a_blind_one(closed_loop, track) -> None:
    """The third flies with the second; the first has its back to the debris and only holds.

    It holds the angles that it measures, which are wrong by 5 %, and does not move.
    """
    there = track(45)
    point_o = there.point_o[:, :, [0, 1, 1]] * np.array([-1.0, 1.0, 1.0])[:, None]
    three = there._replace(
        point_o=point_o,
        velocity_o=there.velocity_o[:, :, [0, 1, 1]],
        rate_o=there.rate_o[:, :, [0, 1, 1]],
    )
    loop = closed_loop(45, reading="conditional")
    loop = replace(loop, track=three, factors=lambda: np.full((1, 50, 3, 6), 1.05))
    angles = np.zeros((1, 3, 3))
    angles[0, 0] = [0.1, -0.2, 0.3]
    pointing = loop.run(angles)
    assert np.argmax(pointing.section[0] == 1) == 25
    assert np.isnan(pointing.pixel[0, :, 0]).all()
    assert np.nanmax(np.abs(pointing.torque[0, :, :, 0])) == 0.0
    np.testing.assert_array_equal(pointing.pixel[:, :, 1], pointing.pixel[:, :, 2])
    assert np.abs(pointing.pixel[0, 33, 1:]).max() < 5.0
    settling = section_metrics(pointing, 1, 1.0).settling_time[0]
    assert np.isnan(settling[0]) and settling[1] == settling[2] < 3.0


def test_a_target_that_leaves_the_image_between_epochs_starts_a_turn(closed_loop, track) -> None:
    """A jump by more than the margin: the last pixel that was seen is what the turn starts from."""
    there = track(12)
    point_o = there.point_o.copy()
    point_o[0, 4:, 1, 0] *= 1.3
    loop = replace(closed_loop(12, reading="conditional"), track=there._replace(point_o=point_o))
    pointing = loop.run(np.zeros((1, 2, 3)))
    assert np.isnan(pointing.pixel[0, 4, 1]).all()
    assert pointing.section[0, 3:6].tolist() == [0, 1, 1]
    assert np.abs(pointing.pixel[0, -1]).max() < 5.0
