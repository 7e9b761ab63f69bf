"""The redundant model: its step against the differential equations, its points against geometry."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics.pointing import camera_axes, camera_rate
from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.problems.camera_range.redundant_model import (
    CORE,
    INERTIA,
    POSITION,
    RATE,
    VELOCITY,
    CameraGeometry,
    Q,
    error_names,
    measurement,
    process,
    redundant_model,
)

N = 1.078007613e-3
KNOWN = CameraGeometry(points=4, mean_motion=N, step=5.0, focal_px=1000.0)
RNG = np.random.default_rng(3)


def _state(points: int = 4, seed: int = 0) -> Array:
    """A state whose points agree: ``r = R p + |rho| e_z``."""
    rng = np.random.default_rng(seed)
    q = quaternion.normalize(rng.standard_normal(4))
    rho = np.array([5.0, 17.3205081, 5.90884652])
    velocity = np.array([9.33582e-3, -1.078007613e-2, -1.12315e-3])
    body = rng.uniform(-1, 1, (points, 3))
    seen = quaternion.rotate(q, body) + np.array([0, 0, np.linalg.norm(rho)])
    rate, inertia = np.radians([0.6, 0.4, 1.0]), [135.4, 208.3, 260.4, 5.0, -3.0, 8.0]
    return np.concatenate([q, rate, rho, velocity, inertia, body.ravel(), seen.ravel()])


def _derivative(_: float, state: Array) -> Array:
    """Eqs 18a-18h as they stand in the camera's axes, without the closed forms of the model."""
    q, w, rho, v = state[Q], state[RATE], state[POSITION], state[VELOCITY]
    xx, yy, zz, xy, xz, yz = state[INERTIA]
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    to_camera, spin_ci = camera_axes(rho).T, camera_rate(rho, v, N)
    spin_ch = spin_ci - to_camera @ [0, 0, N]
    turn = quaternion.to_matrix(quaternion.normalize(q))
    relative = w - turn.T @ spin_ci
    radial = turn.T @ to_camera @ [1.0, 0, 0]
    torque = -np.cross(w, tensor @ w) + 3 * N**2 * np.cross(radial, tensor @ radial)
    points = len(state[CORE:]) // 6
    body = state[CORE : CORE + 3 * points].reshape(points, 3)
    moving = (
        np.cross(turn @ relative, body @ turn.T)
        - to_camera @ v
        + np.cross(spin_ch, to_camera @ rho)
    )
    x, _, z = rho
    acceleration = [3 * N**2 * x + 2 * N * v[1], -2 * N * v[0], -(N**2) * z]
    return np.concatenate(
        [
            0.5 * quaternion.multiply(q, np.append(0.0, relative)),
            np.linalg.solve(tensor, torque),
            *(v, acceleration, np.zeros(6 + 3 * points), moving.ravel()),
        ]
    )


def test_equation_18a_keeps_the_points_where_geometry_has_them() -> None:
    state = _state()
    found = solve_ivp(_derivative, (0, 1000.0), state, method="DOP853", rtol=1e-13, atol=1e-13).y[
        :, -1
    ]
    body, seen = found[CORE : CORE + 12].reshape(4, 3), found[CORE + 12 :].reshape(4, 3)
    turned = quaternion.rotate(quaternion.normalize(found[Q]), body)
    turned[:, 2] += np.linalg.norm(found[POSITION])
    assert np.abs(seen - turned).max() < 1e-9


def test_the_step_is_the_solution_of_the_differential_equations() -> None:
    state = _state()
    found = solve_ivp(_derivative, (0, 5.0), state, method="DOP853", rtol=1e-12, atol=1e-13).y[
        :, -1
    ]
    assert np.allclose(process(KNOWN, state[None])[0], found, atol=2e-7)


def test_steps_keep_what_disagrees_in_the_points_as_it_is() -> None:
    state = _state()
    apart = state.copy()
    apart[KNOWN.camera_points] += 0.3
    difference = process(KNOWN, apart[None])[0] - process(KNOWN, state[None])[0]
    assert np.allclose(difference[KNOWN.camera_points], 0.3)
    assert np.allclose(difference[:CORE], 0)


def test_sigma_points_that_share_a_core_move_as_if_alone() -> None:
    copies = np.tile(_state(), (2, 30, 1))
    copies[1] = _state(seed=1)
    copies[:, :8] += 1e-3 * RNG.standard_normal((2, 8, copies.shape[-1]))
    copies[:, 8:, CORE:] += 1e-2 * RNG.standard_normal((2, 22, 24))
    copies[:, 8:, :CORE] = copies[:, :1, :CORE]
    together = process(KNOWN, copies)
    for run in range(2):
        for copy in (0, 3, 7, 8, 20, 29):
            assert np.allclose(together[run, copy], process(KNOWN, copies[run, copy][None])[0])


def test_pixels_and_range_of_a_point_ahead() -> None:
    state = _state()
    state[CORE + 12 : CORE + 15] = [1.0, -2.0, 20.0]
    shown = measurement(KNOWN, state[None])[0]
    assert shown[:2] == pytest.approx([50.0, -100.0])
    assert shown[-1] == pytest.approx(np.sqrt(5**2 + 17.3205081**2 + 5.90884652**2))
    assert len(shown) == 9


@pytest.mark.parametrize("points", [4, 12])
def test_the_state_has_six_components_per_point_and_19_more(points: int) -> None:
    assert len(error_names(points)) == 6 * points + 19


@pytest.mark.parametrize("seed", range(3))
def test_the_filter_improves_on_its_start_and_keeps_a_factor(seed: int) -> None:
    rng, model = np.random.default_rng(seed), redundant_model(KNOWN, 1.04, 0.01)
    states = np.empty((120, 43))
    states[0] = _state()
    for k in range(1, 120):
        states[k] = process(KNOWN, states[None, k - 1])[0]
    noise = np.append(np.full(8, 1.04), 0.01)
    measured = measurement(KNOWN, states) + noise * rng.standard_normal((120, 9))
    sigma = np.repeat([1e-4, 1e-3, 0.3, 3e-3, 0.1, 0.1], [4, 3, 3, 3, 6, 24])
    guess = states[0] + sigma * rng.standard_normal(43)
    guess[Q] /= np.linalg.norm(guess[Q])
    cubature = UnscentedParameters(1.0, 0.0, 0.0)
    covariance = np.diag(sigma**2)[None]
    found = unscented(model, guess[None], covariance, measured[None], cubature, redraw=True)
    assert found.counts["repairs"][0] == 0
    error = np.abs(found.state[0, -1] - states[-1])
    assert np.linalg.norm(error[VELOCITY]) < 0.5 * np.linalg.norm((guess - states[0])[VELOCITY])
    assert np.median(error[CORE:]) < 0.05
    assert found.nis[0, 60:].mean() / 9 == pytest.approx(1.0, abs=0.25)
