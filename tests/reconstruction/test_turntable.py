"""The table under a body that turns about one axis."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.reconstruction.structure import Structure
from debrisest.reconstruction.turntable import Table, lowered, support_of, table_under

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


def seen_from_above(points, down=25.0):
    """A structure of points about a vertical axis through the middle."""
    base = structure(about_z(np.arange(0, 360, 10)), down)
    return base._replace(points=points + MIDDLE, seen=np.ones((36, len(points)), dtype=bool))


def on_a_disc(rng, radius=2.0, count=400):
    """Points of a body 2 m high, and of a disc under it that turns with it."""
    body = rng.uniform([-0.8, -0.6, -1.0], [0.8, 0.6, 1.0], (600, 3))
    angle, away = rng.uniform(0, 2 * np.pi, count), radius * np.sqrt(rng.uniform(0, 1, count))
    disc = np.stack([away * np.cos(angle), away * np.sin(angle), np.full(count, -1.02)], axis=1)
    return np.concatenate([body, disc + rng.normal(0, 0.002, disc.shape)])


def test_a_disc_with_points_under_the_body_is_its_support():
    points = on_a_disc(np.random.default_rng(3))
    found = support_of(seen_from_above(points))
    below = found.below(points + MIDDLE) > 0.0
    assert below[600:].all()
    assert below[:600].mean() < 0.03
    np.testing.assert_allclose(found.up, [0.0, 0.0, 1.0], atol=2e-3)


def test_a_base_that_reaches_no_farther_than_the_body_or_a_tumbling_body_has_no_support():
    rng = np.random.default_rng(4)
    assert support_of(seen_from_above(on_a_disc(rng, radius=0.5))) is None
    assert support_of(seen_from_above(rng.uniform(-1, 1, (800, 3)))) is None
    tumbling = Rotation.from_euler("zx", np.outer(np.arange(36), [10, 4]), degrees=True)
    loose = structure(tumbling)._replace(points=on_a_disc(rng) + MIDDLE)
    assert support_of(loose) is None


def test_a_base_lies_where_silhouettes_begin_to_close_below_what_is_seen():
    """Silhouettes of a cylinder from 25 deg above: below its base a cone is left."""

    def outside(points):
        away = np.linalg.norm(points[:, :2], axis=1)
        below = np.maximum(-1.0 - points[:, 2], 0.0) / np.tan(np.radians(25.0))
        return np.maximum(away + below - 0.8, points[:, 2] - 1.0)

    points = np.random.default_rng(5).uniform(-0.8, 0.8, (500, 3))
    found = lowered(Table(np.array([0.0, 0.0, 1.0]), -0.92), points, outside, 0.01)
    assert abs(found.height + 1.0) < 0.035
    seen_whole = lowered(Table(np.array([0.0, 0.0, 1.0]), -1.0), points, outside, 0.01)
    assert abs(seen_whole.height + 1.0) < 0.035
