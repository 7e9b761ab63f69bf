"""Gravity gradient: no torque, equilibrium, libration, and the integral of the motion."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array
from debrisest.dynamics.gravity_gradient import tumble
from debrisest.dynamics.kepler import MU_EARTH
from debrisest.dynamics.torque_free import torque_free

RADIUS = 7.178e6
MEAN_MOTION = np.sqrt(MU_EARTH / RADIUS**3)
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])
ALONG_NORMAL = np.array([0.0, 0.0, MEAN_MOTION])


def orbit(times: Array | float) -> Array:
    """Circular orbit in the plane z = 0."""
    phase = MEAN_MOTION * np.asarray(times)
    return RADIUS * np.stack([np.cos(phase), np.sin(phase), np.zeros_like(phase)], axis=-1)


def far_away(_: float) -> Array:
    return np.array([1e14, 0.0, 0.0])


def test_without_torque_it_is_torque_free() -> None:
    times, moments = np.arange(0.0, 400.0, 5.0), np.array([500.0, 900.0, 700.0])
    axes = Rotation.from_rotvec([0.4, -1.0, 0.3])
    inertia = axes.as_matrix() @ np.diag(moments) @ axes.as_matrix().T
    q0, rate0 = np.array([0.1, 0.7, -0.5, 0.5]), np.array([0.1, -0.05, 0.02])
    start = Rotation.from_quat(q0, scalar_first=True)
    q_principal, rate_principal = torque_free(
        times, (start * axes).as_quat(scalar_first=True), axes.inv().apply(rate0), moments
    )
    q, rate = tumble(times, q0, rate0, inertia, far_away)
    error = Rotation.from_quat(q_principal, scalar_first=True) * axes.inv()
    error = error.inv() * Rotation.from_quat(q, scalar_first=True)
    assert np.degrees(error.magnitude()).max() < 1e-6
    np.testing.assert_allclose(rate, axes.apply(rate_principal), atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(q, axis=-1), 1.0, atol=1e-14)


def test_aligned_body_stays_aligned() -> None:
    """Least moment along the radius, largest along the orbit normal."""
    times = np.linspace(0.0, 12000.0, 30)
    q, rate = tumble(times, IDENTITY, ALONG_NORMAL, np.diag([200.0, 700.0, 800.0]), orbit)
    half = 0.5 * MEAN_MOTION * times
    expected = np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=-1)
    np.testing.assert_allclose(q, expected, atol=1e-9)
    np.testing.assert_allclose(rate, np.tile(ALONG_NORMAL, (30, 1)), atol=1e-12)


@pytest.mark.parametrize("moments", [(200.0, 700.0, 800.0), (600.0, 700.0, 900.0)])
def test_pitch_librates_at_the_known_frequency(moments: tuple[float, float, float]) -> None:
    """``sqrt(3 (J_along - J_radial) / J_normal) n`` for small pitch."""
    amplitude = 1e-4
    frequency = MEAN_MOTION * np.sqrt(3 * (moments[1] - moments[0]) / moments[2])
    q0 = Rotation.from_rotvec([0.0, 0.0, amplitude]).as_quat(scalar_first=True)
    times = np.linspace(0.0, 2 * np.pi / frequency, 25)
    q, _ = tumble(times, q0, ALONG_NORMAL, np.diag(moments), orbit)
    pitch = 2 * np.arctan2(q[:, 3], q[:, 0]) - MEAN_MOTION * times
    np.testing.assert_allclose(
        np.sin(pitch), amplitude * np.cos(frequency * times), atol=1e-4 * amplitude
    )


def jacobi_integral(q: Array, rate: Array, inertia: Array, position: Array) -> Array:
    """Energy in the orbiting frame, constant on a circular orbit: ``T - n H_z + V``."""
    attitude = Rotation.from_quat(q, scalar_first=True)
    momentum = rate @ inertia
    up = attitude.inv().apply(position) / RADIUS
    potential = 1.5 * MEAN_MOTION**2 * np.sum(up * (up @ inertia), axis=-1)
    kinetic = 0.5 * np.sum(rate * momentum, axis=-1)
    return kinetic - MEAN_MOTION * attitude.apply(momentum)[:, 2] + potential


def test_tumbling_body_keeps_its_jacobi_integral() -> None:
    inertia = np.array([[300.0, 40.0, -60.0], [40.0, 800.0, 20.0], [-60.0, 20.0, 700.0]])
    times = np.linspace(0.0, 5000.0, 60)
    position: Callable[[float], Array] = orbit
    q, rate = tumble(times, IDENTITY, np.array([3e-3, -4e-3, 2e-3]), inertia, position)
    integral = jacobi_integral(q, rate, inertia, orbit(times))
    np.testing.assert_allclose(integral, np.full(60, integral[0]), rtol=1e-8)
    energy = 0.5 * np.sum(rate * (rate @ inertia), axis=-1)
    assert np.ptp(energy) > 1e-3 * energy[0]


def test_the_first_epoch_alone() -> None:
    q, rate = tumble(np.zeros(1), IDENTITY, ALONG_NORMAL, np.eye(3), orbit)
    np.testing.assert_allclose(q, [IDENTITY], atol=1e-15)
    np.testing.assert_allclose(rate, [ALONG_NORMAL], atol=1e-15)


def test_a_torque_about_a_principal_axis_turns_faster_and_faster() -> None:
    """Closed form: the rate grows linearly, the angle with the square of the time."""
    times, moment = np.arange(0.0, 200.0, 10.0), 700.0
    torque = np.array([0.0, 0.07, 0.0])
    start = np.array([0.0, 1e-3, 0.0])
    inertia = np.diag([500.0, moment, 800.0])
    q, rate = tumble(times, IDENTITY, start, inertia, far_away, torque)
    np.testing.assert_allclose(rate[:, 1], 1e-3 + 1e-4 * times, rtol=1e-10)
    angle = 1e-3 * times + 0.5e-4 * times**2
    turned = Rotation.from_rotvec(angle[:, None] * [0.0, 1.0, 0.0])
    error = turned.inv() * Rotation.from_quat(q, scalar_first=True)
    assert np.abs(error.magnitude()).max() < 1e-9


def test_a_body_that_turns_too_fast_is_not_integrated() -> None:
    """Spun up, or from the start: 150 rad/s are reached, 500 are not."""
    at = lambda _: np.array([7e6, 0.0, 0.0])  # noqa: E731
    times, q0, inertia = np.array([0.0, 1.0]), np.array([1.0, 0, 0, 0]), np.diag([2.0, 2.0, 1.0])
    _, rate = tumble(times, q0, np.zeros(3), inertia, at, np.array([0.0, 0.0, 150.0]))
    assert rate[-1, 2] == pytest.approx(150.0)
    for start, torque in ((0.0, 500.0), (500.0, 0.0)):
        with pytest.raises(ValueError, match="faster than 200 rad/s"):
            tumble(times, q0, np.array([0, 0, start]), inertia, at, np.array([0, 0, torque]))
