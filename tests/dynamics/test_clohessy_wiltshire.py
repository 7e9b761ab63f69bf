"""Closed form of the relative motion against numeric integration and an independent orbit pair."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from debrisest.arrays import Array
from debrisest.dynamics import clohessy_wiltshire as cw
from debrisest.dynamics import kepler
from debrisest.dynamics.relative_motion import drift, hill_frame

N = 1.078007613e-3
POSITION = np.array([5.0, 17.3205081, 5.90884652])
VELOCITY = np.array([9.33582e-3, -1.078007613e-2, -1.12315e-3])


def _derivative(_: float, state: Array) -> Array:
    x, _, z, vx, vy, vz = state
    return np.array([vx, vy, vz, 3 * N**2 * x + 2 * N * vy, -2 * N * vx, -(N**2) * z])


def test_against_numeric_integration_of_an_open_path() -> None:
    start = np.concatenate([POSITION, VELOCITY + np.array([0.01, 0.02, -0.03])])
    times = np.linspace(0, 6000, 13)
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-12}
    exact = solve_ivp(_derivative, (0, 6000), start, t_eval=times, **options).y.T
    position, velocity = cw.propagate(start[:3], start[3:], N, times)
    assert np.allclose(position, exact[:, :3], atol=1e-6)
    assert np.allclose(velocity, exact[:, 3:], atol=1e-9)


def test_against_two_orbits_near_each_other() -> None:
    orbit = kepler.state_from_elements(7e6, 0.0, 1.0, 0.3, 0.0, 0.2)
    times = np.array([0.0, 500.0, 1500.0])
    scale = 1e-2
    apart, _ = drift(*orbit, scale * POSITION, scale * VELOCITY, times)
    frame = hill_frame(*kepler.propagate(*orbit, times))
    in_hill = (np.swapaxes(frame, -1, -2) @ apart[..., None])[..., 0]
    linear, _ = cw.propagate(scale * POSITION, scale * VELOCITY, cw.mean_motion_of(*orbit), times)
    assert np.allclose(in_hill, linear, atol=1e-6)


def test_steps_compose_and_batches_broadcast() -> None:
    whole = cw.transition(N, 700.0)
    assert np.allclose(cw.transition(N, 300.0) @ cw.transition(N, 400.0), whole, atol=1e-9)
    both = np.stack([POSITION, 2 * POSITION])
    moved, _ = cw.propagate(both, np.stack([VELOCITY, 2 * VELOCITY]), N, np.array([0.0, 700.0]))
    assert moved.shape == (2, 2, 3)
    assert np.allclose(moved[1], 2 * moved[0])
    assert np.allclose(moved[0, 1], (whole @ np.append(POSITION, VELOCITY))[:3])


def test_the_closing_velocity_closes_the_path() -> None:
    closed = VELOCITY.copy()
    closed[1] = cw.closing_velocity(POSITION, N)
    ends, _ = cw.propagate(POSITION, closed, N, np.array([0.0, 2 * np.pi / N, 20 * np.pi / N]))
    assert np.allclose(ends, POSITION, atol=1e-9)


def test_an_elliptic_target_is_refused() -> None:
    orbit = kepler.state_from_elements(7e6, 0.02, 1.0, 0.3, 0.0, 0.2)
    with pytest.raises(ValueError, match="circular"):
        cw.mean_motion_of(*orbit)
