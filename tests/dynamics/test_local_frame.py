"""Local orbital axes against the paper's elementary rotations and a differenced frame."""

import numpy as np
import pytest

from debrisest.dynamics import kepler
from debrisest.dynamics.local_frame import local_axes, normal_axis, orbital_rate

INCLINATION, NODE, LATITUDE = np.radians([30.0, 10.0, 98.0])
STATE = kepler.state_from_elements(7.5e6, 0.1, INCLINATION, NODE, np.radians(90.0), np.radians(8.0))


def c1(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, s], [0, -s, c]])


def c3(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])


def test_the_printed_axes_are_the_papers_product_of_rotations() -> None:
    expected = c3(LATITUDE) @ c1(INCLINATION) @ c3(NODE)
    np.testing.assert_allclose(local_axes(*STATE, "printed").T, expected, atol=1e-14)


def test_the_repaired_axes_are_the_same_directions_in_cyclic_order() -> None:
    printed, repaired = local_axes(*STATE, "printed"), local_axes(*STATE)
    order = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    np.testing.assert_array_equal(repaired.T, order @ printed.T)
    assert np.linalg.det(repaired) == pytest.approx(1.0)


@pytest.mark.parametrize("axes", ["repaired", "printed"])
def test_the_axes_turn_about_the_orbit_normal_at_the_orbital_rate(axes) -> None:
    step = 1e-2
    position, velocity = kepler.propagate(*STATE, np.array([-step, 0.0, step]))
    before, now, after = local_axes(position, velocity, axes)
    spin = now.T @ (after - before) / (2 * step)
    rate = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    expected = orbital_rate(*STATE) * normal_axis(axes)
    np.testing.assert_allclose(rate, expected, atol=1e-9)
    assert orbital_rate(*STATE) == pytest.approx(1.19e-3, abs=5e-6)
