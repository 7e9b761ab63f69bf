"""What the controller does, against figures of an independent prototype and from many starts."""

from dataclasses import replace

import numpy as np
import pytest

from debrisest.control import pixel_tracking
from debrisest.control.closed_loop import Pointing
from debrisest.control.metrics import section_metrics
from debrisest.control.two_stage import Switch

MILLI = 1e-3
SHORT = Switch(most=6.0, hold=2.0)


def starts(seed: int, count: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Pixels all over the image, and rates up to several deg/s."""
    rng = np.random.default_rng(seed)
    return rng.uniform([-235, -175], [235, 175], (count, 2)), rng.uniform(-0.1, 0.1, (count, 3))


def test_the_literal_reading_is_that_of_the_prototype(mission) -> None:
    metrics = section_metrics(mission, 1, 1.0)
    assert metrics.start.tolist() == [25.0]
    assert metrics.length == pytest.approx([41.0], abs=1.0)
    np.testing.assert_allclose(metrics.peak_torque / MILLI, [[2.828, 3.979]], rtol=0.005)
    np.testing.assert_allclose(metrics.stage_one_time, [[20.5, 25.9]], atol=1.0)
    np.testing.assert_allclose(metrics.settling_time, [[5.9, 11.6]], atol=0.2)
    assert metrics.total_variation.max() < 10 * MILLI


def test_a_section_that_never_came_has_no_metrics(mission) -> None:
    for value in section_metrics(mission, 7, 1.0):
        assert np.isnan(value).all()


@pytest.mark.parametrize("epochs", [26, 40, 66])
def test_of_a_section_that_is_cut_off_only_the_start_is_known(mission, epochs) -> None:
    start, *others = section_metrics(Pointing(*(x[:, :epochs] for x in mission)), 1, 1.0)
    assert start.tolist() == [25.0]
    for value in others:
        assert np.isnan(value).all()


@pytest.mark.parametrize(
    ("reading", "settling", "stage_one", "peak", "variation"),
    [
        ("saturated", [3.0, 4.1], [4.8, 5.4], 3.98, 8.1),
        ("conditional", [1.4, 1.5], [3.0, 3.0], 3.98, 6.2),
        ("none", [2.2, 2.6], [3.5, 3.8], 2.25, 3.9),
    ],
)
def test_smooth_readings_are_those_of_the_prototype(
    fly, reading, settling, stage_one, peak, variation
) -> None:
    metrics = section_metrics(fly(48, reading=reading), 1, 1.0)
    np.testing.assert_allclose(metrics.settling_time[0], settling, atol=0.15)
    np.testing.assert_allclose(metrics.stage_one_time[0], stage_one, atol=0.2)
    assert metrics.peak_torque.max() / MILLI == pytest.approx(peak, rel=0.005)
    assert metrics.total_variation.max() / MILLI == pytest.approx(variation, rel=0.03)


def test_the_sign_of_the_surface_chatters(fly) -> None:
    metrics = section_metrics(fly(36, reading="sign", switch=SHORT), 1, 1.0)
    assert metrics.total_variation.max() > 40 * MILLI


@pytest.mark.parametrize("reading", ["literal", "saturated", "conditional"])
def test_the_debris_is_centred_from_anywhere(turn, reading) -> None:
    flown = turn(*starts(0), seconds=20.0, reading=reading)
    assert np.abs(flown.pixel[-1]).max() < 5.0
    assert np.abs(flown.rate_b[-1]).max() < 0.02
    assert np.abs(np.diff(flown.torque, axis=0)).sum(0).max() < 10 * MILLI


@pytest.mark.parametrize("plant", [0.5, 2.0])
def test_an_inertia_that_is_wrong_by_a_factor_of_two_is_stood(turn, plant) -> None:
    flown = turn(*starts(1, 10), seconds=8.0, plant=plant, reading="conditional")
    assert np.abs(flown.pixel[-1]).max() < 5.0


def test_measured_rates_and_angles_may_be_half_wrong(turn) -> None:
    error = np.repeat([0.0, 0.5], 10)[:, None, None]
    flown = turn(*starts(2, 20), seconds=18.0, error=error)
    assert np.abs(flown.pixel[-1]).max() < 5.0


def test_a_small_wheel_needs_integrals_that_stand_still(turn) -> None:
    """The prototype: settled after 10.2 s, and 32.3 s with a limit of .03 mN m; lost without."""
    edge = np.array([[237.6, -42.3]] * 2), np.zeros((2, 3))
    limit = np.array([1e-4, 3e-5])
    keys = {"seconds": 34.0, "torque_limit": limit[:, None, None]}
    still, wound = turn(*edge, **keys), turn(*edge, **keys, anti_windup=False)
    for flown in (still, wound):
        np.testing.assert_array_equal(np.abs(flown.torque).max((0, 2)), limit)
    late = np.abs(still.pixel).max(-1) > 5.0
    settled = 0.02 * (len(late) - late[::-1].argmax(0))
    np.testing.assert_allclose(settled, [10.2, 32.3], atol=0.3)
    assert np.abs(wound.pixel).max((0, 2))[1] > 240.0


def test_the_torque_does_not_depend_on_the_control_step(closed_loop) -> None:
    loop = closed_loop(36, switch=SHORT)
    coarse = replace(loop, substeps=25, factors=lambda: np.full((1, 25, 2, 6), 1.05))
    metrics = section_metrics(coarse.run(np.zeros((1, 2, 3))), 1, 1.0)
    np.testing.assert_allclose(metrics.peak_torque / MILLI, [[2.828, 3.979]], rtol=0.005)


def test_gains_that_are_too_large_are_an_outcome_and_no_error(fly) -> None:
    wild = pixel_tracking.GAINS._replace(proportional=np.full(5, 1e7), damping=np.full(2, 1e5))
    pointing = fly(36, tracking=wild, switch=SHORT)
    assert np.isnan(pointing.pixel[0, 30:]).any(axis=(0, 2)).all()
    assert (pointing.section[0, 25:33] == 1).all()
    metrics = section_metrics(pointing, 1, 1.0)
    assert metrics.length.tolist() == [8.0]
    assert np.isnan(metrics.settling_time).all()
    np.testing.assert_allclose(metrics.stage_one_time, 6.0)
