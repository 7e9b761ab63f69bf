"""Sines and cosines in vectors against those of numpy."""

import numpy as np
import pytest

pytest.importorskip("numba")

from debrisest.dynamics.sine_loops import sines


@pytest.mark.parametrize("largest", [1e-8, 1.0, 50.0, 1e4, 1e6])
def test_sines_are_those_of_numpy(largest: float) -> None:
    angle = np.concatenate([np.linspace(-largest, largest, 4001), 0.25 * np.pi * np.arange(-9, 10)])
    sin, cos = np.empty_like(angle), np.empty_like(angle)
    sines(angle, sin, cos)
    np.testing.assert_allclose(sin, np.sin(angle), rtol=0, atol=4e-16)
    np.testing.assert_allclose(cos, np.cos(angle), rtol=0, atol=4e-16)
