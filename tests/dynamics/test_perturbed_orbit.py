"""Perturbed orbits against an adaptive integrator of another order and against Kepler's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from debrisest.dynamics import kepler, perturbed_orbit

MU, RE, J2 = 3.986004418e14, 6378136.3, 1.08262668e-3
START = kepler.state_from_elements(7.493e6, 0.1, *np.radians([20.0, 35.0, 70.0, 8.0]))
TIMES = np.arange(643.0)


def potential(r: np.ndarray, j2: float) -> float:
    """Of the Earth's gravity, J/kg, from Legendre's polynomial of degree two."""
    distance = np.linalg.norm(r)
    legendre = 0.5 * (3.0 * (r[2] / distance) ** 2 - 1.0)
    return float(MU / distance * (1.0 - j2 * (RE / distance) ** 2 * legendre))


@pytest.mark.parametrize("j2", [0.0, J2])
def test_gravity_is_the_gradient_of_the_potential(j2: float) -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        direction = rng.normal(size=3)
        r = 7.3e6 * direction / np.linalg.norm(direction)
        shift = 200.0 * np.eye(3)
        slope = [(potential(r + d, j2) - potential(r - d, j2)) / 400.0 for d in shift]
        np.testing.assert_allclose(perturbed_orbit.gravity(r, j2), slope, rtol=0, atol=2e-8)


def integrated(j2: float, acceleration: np.ndarray, times: np.ndarray) -> np.ndarray:
    """States (time, 6) by DOP853, one step of constant acceleration after the other."""
    state, found = np.concatenate(START), [np.concatenate(START)]
    for extra, begin, end in zip(acceleration, times, times[1:]):

        def derivative(_: float, x: np.ndarray, extra: np.ndarray = extra) -> np.ndarray:
            r, z = np.linalg.norm(x[:3]), x[2]
            k = 1.5 * j2 * MU * RE**2 / r**5
            oblate = -k * x[:3] * (np.array([1, 1, 3]) - 5 * z**2 / r**2)
            return np.concatenate([x[3:], -MU * x[:3] / r**3 + oblate + extra])

        done = solve_ivp(derivative, (begin, end), state, "DOP853", rtol=1e-13, atol=1e-9)
        state = done.y[:, -1]
        found.append(state)
    return np.array(found)


@pytest.mark.parametrize("step", [1.0, 7.0])
def test_oblateness_and_accelerations_against_dop853(step: float) -> None:
    times = np.arange(0.0, 130.0, step)
    acceleration = 0.1 * np.random.default_rng(1).normal(size=(len(times) - 1, 3))
    position, velocity = perturbed_orbit.propagate(*START, times, J2, acceleration)
    expected = integrated(J2, acceleration, times)
    np.testing.assert_allclose(position, expected[:, :3], rtol=0, atol=2e-5)
    np.testing.assert_allclose(velocity, expected[:, 3:], rtol=0, atol=2e-7)


def test_without_perturbation_it_is_keplers() -> None:
    position, velocity = perturbed_orbit.propagate(*START, TIMES)
    exact = kepler.propagate(*START, TIMES)
    np.testing.assert_allclose(position, exact[0], rtol=0, atol=1e-5)
    np.testing.assert_allclose(velocity, exact[1], rtol=0, atol=1e-8)


def test_oblateness_turns_the_node() -> None:
    """The mean rate of the node over an orbit, to first order in J2."""
    a, e, i = 7.493e6, 0.1, np.radians(20.0)
    period = 2 * np.pi * np.sqrt(a**3 / MU)
    position, velocity = perturbed_orbit.propagate(*START, np.linspace(0, period, 500), J2)
    normal = np.cross(position, velocity)[[0, -1]]
    node = np.arctan2(normal[:, 0], -normal[:, 1])
    expected = -1.5 * np.sqrt(MU / a**3) * J2 * (RE / (a * (1 - e**2))) ** 2 * np.cos(i) * period
    assert node[1] - node[0] == pytest.approx(expected, rel=0.03)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.1, 60.0), st.integers(0, 1000))
def test_transition_is_the_derivative_of_keplers_motion(span: float, seed: int) -> None:
    spread = np.repeat([2e5, 200.0], 3)
    state = np.concatenate(START) + spread * np.random.default_rng(seed).normal(size=6)
    scale = np.array([10.0] * 3 + [1e-2] * 3)
    moved = state + np.concatenate([np.diag(scale), -np.diag(scale)])
    ends = np.concatenate(kepler.propagate(moved[:, :3], moved[:, 3:], np.array([span])), axis=-1)[
        :, 0
    ]
    slope = (ends[:6] - ends[6:]).T / (2 * scale)
    given_by = perturbed_orbit.transition(state, span)
    units = np.array([1.0] * 3 + [1e3] * 3)
    error = np.abs(given_by - slope) * units[:, None] / units
    assert error.max() < 1e-7 * (1.0 + 0.5 * span)


def test_runs_are_independent_of_their_companions() -> None:
    acceleration = np.random.default_rng(2).normal(size=(3, 9, 3))
    both, _ = perturbed_orbit.propagate(*START, TIMES[:10], J2, acceleration)
    alone, _ = perturbed_orbit.propagate(*START, TIMES[:10], J2, acceleration[1])
    np.testing.assert_array_equal(both[1], alone)


def test_noise_of_a_step_has_the_covariance_of_a_constant_acceleration() -> None:
    runs, sigma, step = 4000, 0.1, 2.0
    extra = sigma * np.random.default_rng(3).normal(size=(runs, 1, 3))
    times = np.array([0.0, step])
    moved = np.concatenate(perturbed_orbit.propagate(*START, times, 0.0, extra), -1)[:, 1]
    quiet = np.concatenate(perturbed_orbit.propagate(*START, times), -1)[1]
    for axis in range(3):
        found = np.cov((moved - quiet)[:, [axis, axis + 3]].T)
        wanted = sigma**2 * np.array([[step**4 / 4, step**3 / 2], [step**3 / 2, step**2]])
        np.testing.assert_allclose(found, wanted, rtol=0.15)
