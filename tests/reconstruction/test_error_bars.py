"""Error bars of a sphere, whose changes are known in closed form."""

import numpy as np
import pytest

pytest.importorskip("trimesh")

from debrisest.reconstruction.closed_mesh import closed_mesh
from debrisest.reconstruction.error_bars import Doubts, error_bars
from debrisest.vision.solids import revolved

RADIUS = 1.5


def sphere(radius):
    turn = np.linspace(-np.pi / 2, np.pi / 2, 61)
    solid = revolved(list(zip(radius * np.cos(turn), radius * np.sin(turn))), 0.5)
    return closed_mesh(solid.vertices, solid.triangles)


def of(doubts, coarse=RADIUS):
    volume = 4 / 3 * np.pi * RADIUS**3
    moment = 2 / 5 * volume * RADIUS**2
    sigma = error_bars(sphere(RADIUS), sphere(coarse), doubts)
    return sigma[0] / volume, sigma[4:7] / moment


@pytest.mark.parametrize(
    ("doubts", "coarse", "share"),
    [
        (Doubts(0.01, 0.0, 0.0), RADIUS, 0.01),
        (Doubts(0.0, 0.001 * RADIUS, 0.0), RADIUS, 0.001),
        (Doubts(0.0, 0.0, 0.03), RADIUS, 0.01),
        (Doubts(np.inf, 0.0, 0.0), 1.001 * RADIUS, 0.001),
    ],
)
def test_each_doubt_is_a_share_of_the_length_three_and_five_times(doubts, coarse, share):
    volume, moments = of(doubts, coarse)
    assert volume == pytest.approx(3 * share, rel=0.02)
    np.testing.assert_allclose(moments, 5 * share, rtol=0.02)


def test_doubts_add_in_squares():
    volume, _ = of(Doubts(0.01, 0.01 * RADIUS, 0.03))
    assert volume == pytest.approx(3 * 0.01 * np.sqrt(3), rel=0.02)
