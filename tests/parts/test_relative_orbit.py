"""An observer that flies freely: closed forms of what opens a relative orbit."""

import numpy as np
import pytest

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.parts.truth.kepler_orbit import KeplerOrbit
from debrisest.parts.truth.relative_orbit import RelativeOrbit

PLACE = [0.05, 0.2, 0.06]
N = np.sqrt(3.986004418e14 / 7e6**3)
PERIOD = 2 * np.pi / N


def flown(velocity: list[float], eccentricity: float = 0.0) -> dict[str, np.ndarray]:
    clock, draws = Clock.regular(PERIOD * 1.5, PERIOD / 2), Draws(1, "case", [0])
    orbit = KeplerOrbit(kind="kepler", semi_major_axis_km=7000.0, eccentricity=eccentricity)
    data = orbit.simulate({}, clock, draws)
    chaser = RelativeOrbit(kind="relative_orbit", position_m=PLACE, velocity_m_s=velocity)
    return data | chaser.simulate(data, clock, draws)


@pytest.mark.parametrize("excess", [0.0, 1e-4, -3e-4])
def test_an_orbit_drifts_along_track_by_three_periods_of_the_excess(excess: float) -> None:
    """Clohessy and Wiltshire: ``-3 T (v_y + 2 n x)`` in a period, nothing across."""
    data = flown([1e-4, -2 * N * PLACE[0] + excess, 2e-4])
    drift = -3 * PERIOD * excess
    second_order = 10 * drift**2 / 7e6 + 1e-6
    moved = data["chaser_position_h"][0, 2] - PLACE
    assert moved == pytest.approx([0.0, drift, 0.0], abs=second_order)
    change = data["chaser_velocity_h"][0, 2] - data["chaser_velocity_h"][0, 0]
    assert np.abs(change).max() < N * second_order


def test_on_the_targets_ellipse_it_stays_behind_by_the_same_time() -> None:
    """A chaser on the very orbit of an eccentric target, as far ahead as it flies in a moment."""
    moment, e = 1e-3, 0.3
    orbit = KeplerOrbit(kind="kepler", semi_major_axis_km=7e3 / (1 - e), eccentricity=e)
    clock, draws = Clock(np.array([0.0, 1500.0, 3000.0])), Draws(1, "case", [0])
    data = orbit.simulate({}, clock, draws)
    position, velocity = data["orbit_position"][0], data["orbit_velocity"][0]
    speed = np.linalg.norm(velocity[0])
    turning = speed / 7e6
    tangential = -(turning**2) * 7e6 * moment + 3.986004418e14 / 49e12 * moment
    chaser = RelativeOrbit(
        kind="relative_orbit",
        position_m=[0.0, speed * moment, 0.0],
        velocity_m_s=[-tangential, 0.0, 0.0],
    )
    found = chaser.simulate(data, clock, draws)["chaser_position_h"][0]
    assert np.linalg.norm(found, axis=-1) == pytest.approx(
        moment * np.linalg.norm(velocity, axis=-1), rel=1e-5
    )
    assert np.linalg.norm(position[1]) > 1.2 * np.linalg.norm(position[0])
