"""Lens distortion against the formula as OpenCV's manual has it, written out term by term."""

import numpy as np
import pytest

from debrisest.sensors.distortion import distorted, undistorted

LENSES = [(), (-0.22,), (0.1, -0.05, 1e-3, -2e-3), (-0.22, 0.51, -6e-4, -2e-4, -0.13)]


def by_hand(x: float, y: float, k1=0.0, k2=0.0, p1=0.0, p2=0.0, k3=0.0) -> tuple[float, float]:
    r2 = x**2 + y**2
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x**2),
        y * radial + p1 * (r2 + 2 * y**2) + 2 * p2 * x * y,
    )


@pytest.mark.parametrize("lens", LENSES)
def test_distortion_is_the_written_formula(lens) -> None:
    slope = np.random.default_rng(0).uniform(-0.6, 0.6, (50, 2))
    expected = [by_hand(*each, *lens) for each in slope]
    np.testing.assert_allclose(distorted(slope, lens), expected, rtol=0, atol=1e-15)


@pytest.mark.parametrize("lens", LENSES)
def test_undistorted_slopes_are_those_before(lens) -> None:
    slope = np.random.default_rng(1).uniform(-0.5, 0.5, (7, 30, 2))
    slope[3, 4] = np.nan
    shown = distorted(slope, lens)
    np.testing.assert_allclose(undistorted(shown, lens), slope, rtol=0, atol=1e-11)


def test_what_the_lens_cannot_show_is_not_a_number() -> None:
    """With k1 = -0.3 a slope r shows at r - 0.3 r^3, at most 0.703: beyond it there is nothing."""
    found = undistorted(np.array([[0.5, 0.0], [0.71, 0.0], [9.0, 9.0]]), (-0.3,))
    assert np.isfinite(found[0]).all() and np.isnan(found[1:]).all()
