"""Relative motion against inertial integration and the Clohessy-Wiltshire solution."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from debrisest.arrays import Array
from debrisest.dynamics.kepler import MU_EARTH, propagate, state_from_elements
from debrisest.dynamics.relative_motion import drift, hill_frame, hold

RADIUS = 7.178e6
MEAN_MOTION = np.sqrt(MU_EARTH / RADIUS**3)
CIRCLE = state_from_elements(RADIUS, 0.0, 1.72, 0.3, 0.0, 0.8)
ELLIPSE = state_from_elements(1.2e7, 0.35, 0.9, 2.0, 4.0, 1.1)
metres = st.floats(-20.0, 20.0)
metres_per_second = st.floats(-0.02, 0.02)


def in_hill_axes(target: tuple[Array, Array], times: Array, relative: Array) -> Array:
    frames = hill_frame(*propagate(*target, times))
    return (np.swapaxes(frames, -1, -2) @ relative[..., None])[..., 0]


def test_hill_axes() -> None:
    position, velocity = ELLIPSE
    radial, along, normal = hill_frame(position, velocity).T
    np.testing.assert_allclose(radial, position / np.linalg.norm(position), atol=1e-15)
    np.testing.assert_allclose(np.cross(radial, along), normal, atol=1e-15)
    assert normal @ position == pytest.approx(0.0, abs=1e-8)
    assert normal @ velocity == pytest.approx(0.0, abs=1e-11)
    assert along @ velocity > 0.0
    circular = hill_frame(*CIRCLE)
    np.testing.assert_allclose(circular[:, 1], CIRCLE[1] / np.linalg.norm(CIRCLE[1]), atol=1e-15)


def test_hold_stays_ahead_on_the_track() -> None:
    """30 m ahead along track is where the target will be a little later."""
    times = np.arange(0.0, 6000.0, 100.0)
    position, velocity = propagate(*CIRCLE, times)
    chaser = hold(position, velocity, np.array([0.0, 30.0, 0.0]))
    later, _ = propagate(*CIRCLE, times + 30.0 / (MEAN_MOTION * RADIUS))
    np.testing.assert_allclose(position + chaser, later, atol=1e-4)
    batch = hold(np.stack([position] * 2), np.stack([velocity] * 2), np.array([1.0, 2.0, 3.0]))
    assert batch.shape == (2, 60, 3)
    np.testing.assert_allclose(np.linalg.norm(batch, axis=-1), np.sqrt(14.0), rtol=1e-14)


@pytest.mark.parametrize("target", [CIRCLE, ELLIPSE])
def test_drift_matches_integration_of_both_bodies(target: tuple[Array, Array]) -> None:
    offset, velocity, times = np.array([900.0, -2000.0, 500.0]), np.array([1.0, 2.0, -3.0]), 4000.0
    frame, momentum = hill_frame(*target), np.cross(*target)
    r, v = (frame @ x for x in (offset, velocity))
    v = v + np.cross(momentum, r) / (target[0] @ target[0])

    def derivative(_: float, state: Array) -> Array:
        p, q = state[:3], state[6:9]
        pull_p, pull_q = (-MU_EARTH * x / np.linalg.norm(x) ** 3 for x in (p, q))
        return np.concatenate([state[3:6], pull_p, state[9:], pull_q])

    start = np.concatenate([*target, target[0] + r, target[1] + v])
    end = solve_ivp(derivative, (0, times), start, "DOP853", rtol=1e-13, atol=1e-9).y[:, -1]
    relative, closing = drift(*target, offset, velocity, np.array([times]))
    np.testing.assert_allclose(relative[0], end[6:9] - end[:3], atol=1e-4)
    np.testing.assert_allclose(closing[0], end[9:] - end[3:6], atol=1e-7)


@given(st.tuples(metres, metres, metres), st.tuples(*[metres_per_second] * 3))
def test_drift_of_a_near_chaser_is_clohessy_wiltshire(offset, velocity) -> None:
    """x radial, y along track, z normal; the neglected terms are of order ``distance^2/r``."""
    times = np.arange(0.0, 3000.0, 50.0)
    relative, _ = drift(*CIRCLE, np.array(offset), np.array(velocity), times)
    (x, y, z), (u, v, w), n = offset, velocity, MEAN_MOTION
    c, s = np.cos(n * times), np.sin(n * times)
    expected = [
        (4 - 3 * c) * x + s * u / n + 2 * (1 - c) * v / n,
        6 * (s - n * times) * x + y - 2 * (1 - c) * u / n + (4 * s - 3 * n * times) * v / n,
        c * z + s * w / n,
    ]
    moved = in_hill_axes(CIRCLE, times, relative)
    bound = 1e-6 + 20.0 * np.abs(expected).max() ** 2 / RADIUS
    np.testing.assert_allclose(moved, np.transpose(expected), atol=bound)


@pytest.mark.parametrize("target", [CIRCLE, ELLIPSE])
def test_initial_velocity_is_that_of_the_rotating_frame(target: tuple[Array, Array]) -> None:
    offset, velocity = np.array([40.0, -60.0, 25.0]), np.array([0.3, -0.1, 0.2])
    times = np.array([-0.01, 0.0, 0.01])
    relative, _ = drift(*target, offset, velocity, times)
    seen = in_hill_axes(target, times, relative)
    np.testing.assert_allclose(seen[1], offset, atol=1e-8)
    np.testing.assert_allclose((seen[2] - seen[0]) / 0.02, velocity, atol=2e-6)


def test_drift_batches_over_chasers() -> None:
    offsets = np.arange(12.0).reshape(4, 3)
    relative, closing = drift(*CIRCLE, offsets, np.zeros(3), np.arange(5.0))
    assert relative.shape == closing.shape == (4, 5, 3)
    alone, _ = drift(*CIRCLE, offsets[2], np.zeros(3), np.arange(5.0))
    np.testing.assert_allclose(relative[2], alone, atol=1e-8)
