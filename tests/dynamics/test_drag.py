"""Drag: what it takes from an orbit, and where it points."""

import numpy as np
import pytest

from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.dynamics import kepler, perturbed_orbit
from debrisest.dynamics.drag import EARTH_TURN, Drag, drag_acceleration
from debrisest.parts.truth.perturbed_orbit import Air, PerturbedOrbit

MU, RADIUS = 3.986004418e14, 6.778137e6
AIR = Drag(ballistic=0.22, density=3e-12, radius=RADIUS, scale_height=6e4)


def test_it_is_against_the_flow_of_the_turning_air_and_falls_with_height() -> None:
    at = np.array([[RADIUS, 0.0, 0.0], [RADIUS + 6e4, 0.0, 0.0], [0.0, 0.0, RADIUS]])
    velocity = np.array([0.0, 7e3, 3e3])
    found = drag_acceleration(at, np.broadcast_to(velocity, (3, 3)), AIR)
    flow = velocity - [0.0, EARTH_TURN * RADIUS, 0.0]
    assert found[0] == pytest.approx(-0.5 * 3e-12 * 0.22 * np.linalg.norm(flow) * flow)
    assert np.linalg.norm(found[1]) == pytest.approx(np.linalg.norm(found[0]) / np.e, rel=0.01)
    assert found[2] == pytest.approx(-0.5 * 3e-12 * 0.22 * np.linalg.norm(velocity) * velocity)


def test_a_circle_shrinks_in_a_period_as_the_textbook_says() -> None:
    """``da = -2 pi B rho a^2`` for still air; over the poles the turning air changes 0.3 %."""
    start = kepler.state_from_elements(RADIUS, 0.0, np.pi / 2, 0.0, 0.0, 0.0)
    period = 2 * np.pi * np.sqrt(RADIUS**3 / MU)
    times = np.linspace(0.0, period, 1200)
    still = AIR._replace(scale_height=1e9)
    position, velocity = perturbed_orbit.propagate(*start, times, drag=still)
    energy = 0.5 * np.sum(velocity**2, -1) - MU / np.linalg.norm(position, axis=-1)
    axis = -0.5 * MU / energy
    expected = -2 * np.pi * 0.22 * 3e-12 * RADIUS**2
    assert axis[-1] - axis[0] == pytest.approx(expected, rel=1e-2)


def test_a_scenario_has_drag_and_a_constant_acceleration() -> None:
    elements = {"semi_major_axis_km": 6778.137, "inclination_deg": 51.6}
    clock, draws = Clock.regular(600.0, 60.0), Draws(1, "case", [0])
    air = Air(area_to_mass_m2_kg=0.1, density_kg_m3=3e-12, altitude_km=400.0, scale_height_km=60.0)
    assert air.drag() == pytest.approx(AIR)

    def end(**keys: object) -> np.ndarray:
        orbit = PerturbedOrbit.model_validate({"kind": "perturbed"} | elements | keys)
        return np.asarray(orbit.simulate({}, clock, draws)["orbit_position"][0, -1])

    free, pushed = end(), end(acceleration_m_s2=[1e-3, 0.0, 0.0])
    dragged = end(air=air.model_dump())
    start = kepler.state_from_elements(RADIUS, 0.0, np.radians(51.6), 0.0, 0.0, 0.0)
    forward = start[1] / np.linalg.norm(start[1])
    size = 0.5 * 0.22 * 3e-12 * np.linalg.norm(start[1]) ** 2
    assert 0.5 < -(dragged - free) @ forward / (0.5 * size * 540.0**2) < 1.0
    assert (pushed - free)[0] == pytest.approx(0.5 * 1e-3 * 540.0**2, rel=0.3)


def test_accelerations_may_differ_by_axis() -> None:
    clock, draws = Clock.regular(3.0, 1.0), Draws(1, "case", range(400))
    elements = {"semi_major_axis_km": 7493.0, "acceleration_noise_m_s2": [0.3, 0.0, 0.1]}
    orbit = PerturbedOrbit.model_validate({"kind": "perturbed"} | elements)
    change = orbit.simulate({}, clock, draws)["orbit_velocity"][:, 1]
    assert change.std(axis=0) == pytest.approx([0.3, 0.0, 0.1], rel=5 / np.sqrt(800), abs=1e-9)
