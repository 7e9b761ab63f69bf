"""The printed estimation equations of Li et al. (2011) that are wrong, each shown to be."""

import numpy as np
import pytest

from debrisest.dynamics import kepler, perturbed_orbit

START = kepler.state_from_elements(7.493e6, 0.1, *np.radians([20.0, 35.0, 70.0, 8.0]))
STATE = np.concatenate(START)


def slope(state: np.ndarray) -> np.ndarray:
    """A of the text before Eq 8: derivative of (v, -mu r / r^3)."""
    r, distance = state[:3], np.linalg.norm(state[:3])
    gradient = -kepler.MU_EARTH / distance**3 * (np.eye(3) - 3 * np.outer(r, r) / distance**2)
    return np.block([[np.zeros((3, 3)), np.eye(3)], [gradient, np.zeros((3, 3))]])


def test_a_of_equation_15_is_no_transition() -> None:
    """P' = A P A^T + Q forgets the position's variance, whatever the step."""
    covariance = np.diag([1e4] * 6)
    a, phi = slope(STATE), perturbed_orbit.transition(STATE, 1.0)
    printed, right = a @ covariance @ a.T, phi @ covariance @ phi.T
    assert np.trace(printed[3:, 3:]) < 1e-6 * np.trace(covariance[3:, 3:])
    np.testing.assert_allclose(np.trace(right[3:, 3:]), 3e4, rtol=1e-3)
    np.testing.assert_allclose(phi, np.eye(6) + a, atol=3e-6)
    rng = np.random.default_rng(0)
    spread = 100.0 * rng.normal(size=(4000, 6))
    ends = kepler.propagate(START[0] + spread[:, :3], START[1] + spread[:, 3:], np.array([1.0]))
    moved = np.concatenate(ends, axis=-1)[:, 0]
    np.testing.assert_allclose(np.cov(moved.T), right, rtol=0.1, atol=1500.0)


def test_the_orbit_elements_are_not_constant() -> None:
    """Text after Eq 2: with the anomaly constant too, Eq 2 turns by nothing, the orbit by 2 deg."""
    moved, _ = kepler.propagate(*START, np.array([0.0, 25.0]))
    unit = moved / np.linalg.norm(moved, axis=-1, keepdims=True)
    assert np.degrees(np.arccos(unit[0] @ unit[1])) == pytest.approx(1.7, abs=0.3)


def test_the_gate_of_table_2_lets_more_pass_than_its_p_g() -> None:
    """Chi-square of two components is below 5 with 1 - exp(-5/2); of four with 0.71."""
    two = 1 - np.exp(-2.5)
    four = 1 - np.exp(-2.5) * (1 + 2.5)
    assert two == pytest.approx(0.918, abs=1e-3)
    assert four == pytest.approx(0.713, abs=1e-3)
    assert -2 * np.log(1 - 0.9) == pytest.approx(4.605, abs=1e-3)


def test_equation_13_at_the_papers_numbers() -> None:
    """Three validated points, P_G = 0.9: 0.634; printed, with C on top, 6.26."""
    common = 2 * np.pi / 5 * 3 * (1 - 0.7 * 0.9) / 0.7
    assert common / np.pi == pytest.approx(0.634, abs=1e-3)
    assert common * np.pi == pytest.approx(6.26, abs=0.01)


def test_a_single_beta_is_no_probability_of_two_cameras() -> None:
    """Eq 16 for two cameras: of a scalar state seen once, the product of both beta_0 is too sure.

    A camera that sees the target for certain and one that sees nothing: the printed P is that of
    two measurements, the mixture's that of one.
    """
    prior, noise = 4.0, 1.0
    one = 1 / (1 / prior + 1 / noise)
    two = 1 / (1 / prior + 2 / noise)
    beta_0 = 0.0 * 1.0
    printed = beta_0 * prior + (1 - beta_0) * two
    assert printed == two < one
