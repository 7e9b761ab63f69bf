"""The table under a body that turns about one axis."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.reconstruction.structure import Structure
from debrisest.reconstruction.turntable import table_under

MIDDLE = np.array([3.0, 0.0, 0.5])
POINTS = MIDDLE + np.random.default_rng(1).uniform(-1, 1, (2000, 3))


def structure(turn, down=25.0):
    """A camera 10 m away that looks down on the middle of the points, z of which is upwards."""
    level = Rotation.from_matrix([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
    rotation = (Rotation.from_euler("x", down, degrees=True) * level * turn).as_matrix()
    translation = [0.0, 0.0, 10.0] - rotation @ MIDDLE
    seen = np.ones((len(rotation), 1), dtype=bool)
    return Structure(rotation, translation, POINTS[:1], seen, np.inf, 0.5)


def about_z(degrees):
    return Rotation.from_euler("z", degrees[:, None], degrees=True)


@pytest.mark.parametrize(("down", "up"), [(25.0, 1.0), (-25.0, -1.0)])
def test_the_table_is_at_the_lowest_points_on_the_side_away_from_the_camera(down, up):
    found = table_under(POINTS, structure(about_z(np.arange(0, 360, 10)), down))
    np.testing.assert_allclose(found.up, [0.0, 0.0, up], atol=1e-9)
    lowest = np.min(POINTS[:, 2] * up)
    assert lowest <= found.height < lowest + 0.05
    above = np.array([3.0, 0.0, (found.height + 0.1) * up])
    np.testing.assert_allclose(found.below(above[None]), [-0.1])


def test_a_body_that_tumbles_or_turns_little_or_is_seen_level_stands_on_nothing():
    tumbling = Rotation.from_euler("zx", np.outer(np.arange(36), [10, 4]), degrees=True)
    assert table_under(POINTS, structure(tumbling)) is None
    assert table_under(POINTS, structure(about_z(np.linspace(0, 30, 12)))) is None
    assert table_under(POINTS, structure(about_z(np.arange(0, 360, 10)), down=1.0)) is None
