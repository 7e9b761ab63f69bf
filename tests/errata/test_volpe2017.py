"""What is wrong in Volpe, Palmerini, Sabatini (2017), each with its arc."""

import numpy as np
import pytest

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics.gravity_gradient import tumble
from debrisest.dynamics.kepler import MU_EARTH
from debrisest.target.surface import box_faces, depth_along

RADIUS = 7e6
N = np.sqrt(MU_EARTH / RADIUS**3)
MOMENTS = np.array([135.4, 208.3, 260.4])
ALONG = np.array([1.0, 0.0, 0.0, 0.0])


def _orbit(time: float) -> Array:
    return RADIUS * np.array([np.cos(N * time), np.sin(N * time), 0.0])


def _turned(inertia: Array, rate_deg: list[float], duration: float) -> Array:
    return tumble(np.array([0.0, duration]), ALONG, np.radians(rate_deg), inertia, _orbit)[0][-1]


def test_of_equation_18d_only_the_scale_of_the_inertia_cancels() -> None:
    """Section 8 says that the inertia cancels, so that no measurement tells of it."""
    nominal, rate = np.diag(MOMENTS), [0.6, 0.4, 1.0]
    scaled = quaternion.angle_between(
        _turned(nominal, rate, 600.0), _turned(10 * nominal, rate, 600.0)
    )
    assert scaled < 1e-7
    other = np.diag(MOMENTS * [1.01, 1.0, 1.0])
    changed = quaternion.angle_between(_turned(nominal, rate, 600.0), _turned(other, rate, 600.0))
    shift_px = 1000 * float(changed) * 1.0 / 20.0
    assert shift_px > 0.5


def test_gravity_gradient_tells_ratios_even_of_a_target_at_rest() -> None:
    at_rest = [0.0, 0.0, float(np.degrees(N))]
    tilted = quaternion.to_matrix(quaternion.exp(np.radians([20.0, 30.0, 10.0])))
    nominal = tilted @ np.diag(MOMENTS) @ tilted.T
    other = tilted @ np.diag(MOMENTS * [1.01, 1.0, 1.0]) @ tilted.T
    end = 2 * np.pi / N
    changed = quaternion.angle_between(_turned(nominal, at_rest, end), _turned(other, at_rest, end))
    assert 1000 * float(changed) / 20.0 > 0.3


def test_a_range_finder_shows_the_surface_not_the_centre_of_mass() -> None:
    """Section 6.1 measures |rho| to 10 mm; a laser misses the centre by its depth."""
    directions = np.random.default_rng(1).standard_normal((2000, 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    depth = depth_along(directions, box_faces(np.array([1.0, 0.75, 0.5])))
    assert depth.min() >= 0.5
    assert depth.mean() == pytest.approx(0.85, abs=0.05)
    assert depth.std() > 0.1


def test_one_relative_orbit_does_not_show_a_still_target_from_all_sides() -> None:
    """On a closed ellipse the line of sight is nearly fixed in inertial axes."""
    times = np.linspace(0, 2 * np.pi / N, 200)
    phase = N * times + np.radians(30)
    place = np.stack([10 * np.sin(phase), 20 * np.cos(phase), 6 * np.sin(N * times + 1.75)], -1)
    turn = quaternion.exp(np.stack([0 * times, 0 * times, N * times], -1))
    sight = quaternion.rotate(turn, place / np.linalg.norm(place, axis=-1, keepdims=True))
    level = np.degrees(np.unwrap(np.arctan2(sight[:, 1], sight[:, 0])))
    assert np.ptp(level) < 60
