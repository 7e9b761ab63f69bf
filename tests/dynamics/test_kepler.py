"""Two-body motion against numerical integration and the integrals of the motion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from debrisest.arrays import Array
from debrisest.dynamics.kepler import (
    MU_EARTH,
    position_until,
    propagate,
    shape_and_anomaly,
    state_from_elements,
)

angle = st.floats(0.0, 2 * np.pi)
ellipse = st.tuples(
    st.floats(6.6e6, 5e7),
    st.one_of(st.sampled_from([0.0, 1e-12, 1e-3, 0.97]), st.floats(0.0, 0.95)),
    st.one_of(st.sampled_from([0.0, np.pi / 2, np.pi]), st.floats(0.0, np.pi)),
    angle,
    angle,
    angle,
)


def integrate(position: Array, velocity: Array, times: Array) -> tuple[Array, Array]:
    def derivative(_: float, state: Array) -> Array:
        r = state[:3]
        return np.concatenate([state[3:], -MU_EARTH * r / np.linalg.norm(r) ** 3])

    start = np.concatenate([position, velocity])
    solution = solve_ivp(
        derivative, (0, times[-1]), start, "DOP853", t_eval=times, rtol=1e-12, atol=1e-6
    )
    return solution.y[:3].T, solution.y[3:].T


@pytest.mark.parametrize("eccentricity", [0.0, 0.01, 0.3, 0.8])
def test_matches_integration(eccentricity: float) -> None:
    position, velocity = state_from_elements(1.2e7, eccentricity, 1.7, 0.4, 2.0, 3.5)
    times = np.linspace(0.0, 30000.0, 50)
    for ours, theirs in zip(
        propagate(position, velocity, times), integrate(position, velocity, times)
    ):
        np.testing.assert_allclose(ours, theirs, atol=1e-7 * np.abs(theirs).max())


@given(ellipse)
def test_elements_fix_the_integrals_of_the_motion(elements) -> None:
    a, e, i, node, periapsis, anomaly = elements
    position, velocity = state_from_elements(*elements)
    radius = np.linalg.norm(position)
    momentum = np.cross(position, velocity)
    normal = [np.sin(i) * np.sin(node), -np.sin(i) * np.cos(node), np.cos(i)]
    size = np.sqrt(MU_EARTH * a * (1 - e**2))
    np.testing.assert_allclose(momentum / size, normal, atol=1e-12)
    energy = velocity @ velocity / 2 - MU_EARTH / radius
    assert energy == pytest.approx(-MU_EARTH / (2 * a), rel=1e-10)
    to_periapsis = np.cross(velocity, momentum) / MU_EARTH - position / radius
    assert np.linalg.norm(to_periapsis) == pytest.approx(e, abs=1e-12)
    assert to_periapsis @ position == pytest.approx(e * radius * np.cos(anomaly), abs=1e-12 * a)
    assert to_periapsis[2] == pytest.approx(e * np.sin(i) * np.sin(periapsis), abs=1e-12)
    assert position[2] == pytest.approx(
        radius * np.sin(i) * np.sin(periapsis + anomaly), abs=1e-12 * a
    )


@given(ellipse, st.floats(-2e5, 2e5))
def test_there_and_back_again(elements, time) -> None:
    position, velocity = state_from_elements(*elements)
    there = propagate(position, velocity, np.array([0.0, time]))
    scale = np.linalg.norm(position)
    np.testing.assert_allclose(there[0][0], position, atol=1e-9 * scale)
    np.testing.assert_allclose(there[1][0], velocity, atol=1e-9 * np.linalg.norm(velocity))
    back, _ = propagate(there[0][1], there[1][1], np.array([-time]))
    np.testing.assert_allclose(back[0], position, atol=1e-6 * elements[0])


@given(ellipse)
def test_returns_after_a_period_and_reaches_the_apsides(elements) -> None:
    a, e, *_ = elements
    period = 2 * np.pi * np.sqrt(a**3 / MU_EARTH)
    position, velocity = state_from_elements(*elements[:5], 0.0)
    positions, _ = propagate(position, velocity, period * np.array([0.0, 0.5, 1.0, 7.0]))
    np.testing.assert_allclose(positions[[0, 2, 3]] / a, [position / a] * 3, atol=1e-9)
    assert np.linalg.norm(position) == pytest.approx(a * (1 - e), rel=1e-12)
    np.testing.assert_allclose(positions[1] / a, -position / a * (1 + e) / (1 - e), atol=1e-9)


def test_batch_axes() -> None:
    elements = np.array([[7e6, 0.0], [8e6, 0.1], [4e7, 0.7]])
    position, velocity = state_from_elements(*elements.T, 1.0, 2.0, np.zeros((2, 1)), 0.1)
    assert position.shape == velocity.shape == (2, 3, 3)
    times = np.array([10.0, 5.0, 4000.0, -3.0])
    positions, velocities = propagate(position, velocity, times)
    assert positions.shape == velocities.shape == (2, 3, 4, 3)
    alone, _ = propagate(position[1, 2], velocity[1, 2], times)
    np.testing.assert_allclose(positions[1, 2], alone, rtol=1e-12)


def test_open_orbits_are_refused() -> None:
    position = np.array([7e6, 0.0, 0.0])
    escape = np.array([0.0, np.sqrt(2 * MU_EARTH / 7e6) * 1.0001, 0.0])
    with pytest.raises(ValueError, match="elliptic"):
        propagate(position, np.stack([0.5 * escape, escape]), np.zeros(1))
    with pytest.raises(ValueError, match="ellipse"):
        state_from_elements(7e6, 1.0, 0.0, 0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="ellipse"):
        state_from_elements(-7e6, 0.1, 0.0, 0.0, 0.0, 0.0)


@given(
    axis=st.floats(6.6e6, 5e7),
    eccentricity=st.floats(1e-3, 0.9),
    anomaly=st.floats(-3.1, 3.1),
    angles=st.tuples(*[st.floats(0.0, 3.0)] * 3),
)
def test_shape_and_anomaly_are_those_of_the_elements(
    axis: float, eccentricity: float, anomaly: float, angles: tuple[float, float, float]
) -> None:
    found = shape_and_anomaly(*state_from_elements(axis, eccentricity, *angles, anomaly))
    assert found[0] == pytest.approx(axis, rel=1e-9)
    assert found[1] == pytest.approx(eccentricity, rel=1e-8)
    assert found[2] == pytest.approx(anomaly, abs=1e-8)


@pytest.mark.parametrize("eccentricity", [0.0, 0.01, 0.3, 0.8])
def test_one_position_at_a_time_is_that_of_all(eccentricity: float) -> None:
    position, velocity = state_from_elements(1.2e7, eccentricity, 1.7, 0.4, 2.0, 3.5)
    times = np.linspace(0.0, 30000.0, 501)
    at = position_until(30000.0, position, velocity)
    expected = propagate(position, velocity, times)[0]
    np.testing.assert_allclose([at(time) for time in times], expected, atol=1e-14 * 1.2e7)
