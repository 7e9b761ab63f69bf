"""Lines and convex bodies, against marching along the line in small steps."""

import numpy as np
import pytest

from debrisest.arrays import Array
from debrisest.target.surface import box_faces, depth_along, hidden_by_box, hull_faces

HALF = np.array([1.0, 0.75, 0.5])


def _directions(count: int, seed: int) -> Array:
    drawn = np.random.default_rng(seed).standard_normal((count, 3))
    return np.asarray(drawn / np.linalg.norm(drawn, axis=-1, keepdims=True))


def test_depth_of_a_box_by_marching() -> None:
    lengths = np.arange(0, 1.5, 1e-4)
    for direction in _directions(20, 0):
        inside = (np.abs(lengths[:, None] * direction) <= HALF).all(-1)
        assert depth_along(direction, box_faces(HALF)) == pytest.approx(
            lengths[inside][-1], abs=2e-4
        )


def test_the_hull_of_a_boxs_corners_is_the_box() -> None:
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * HALF
    directions = _directions(50, 1)
    assert np.allclose(
        depth_along(directions, hull_faces(corners)), depth_along(directions, box_faces(HALF))
    )


def test_a_hull_beside_the_centre_of_mass_is_refused() -> None:
    with pytest.raises(ValueError, match="outside the hull"):
        hull_faces(np.array([[1.0, 0, 0], [2, 0, 0], [1, 1, 0], [1, 0, 1], [1, 1, 1]]))


@pytest.mark.parametrize("count", [3, 4, 9])
def test_points_in_a_plane_have_no_hull(count: int) -> None:
    flat = np.random.default_rng(0).standard_normal((count, 3)) * [1.0, 1.0, 0.0]
    with pytest.raises(ValueError, match="lie in a plane; give half_sides_m"):
        hull_faces(flat)


def test_hidden_points_by_marching() -> None:
    rng = np.random.default_rng(2)
    points = np.concatenate([2 * rng.uniform(-1, 1, (60, 3)), [[1.0, 0.75, 0.5], [0.6, 0.1, 0.5]]])
    points = points[~(np.abs(points) < HALF).all(-1)]
    steps = np.linspace(0, 1, 4001)[1:, None, None]
    for observer in 10 * _directions(10, 3):
        on_the_way = points + steps * (observer - points)
        through = (np.abs(on_the_way) < HALF - 1e-3).all(-1).sum(0)
        hidden = hidden_by_box(points, observer, HALF)
        assert hidden[through > 0].all()
        beside = (np.abs(on_the_way) < HALF + 1e-3).all(-1).sum(0)
        assert not hidden[beside == 0].any()


def test_a_corner_is_hidden_where_all_three_faces_turn_their_backs() -> None:
    seen = np.mean([not hidden_by_box(HALF[None], 1e6 * d, HALF)[0] for d in _directions(2000, 4)])
    assert seen == pytest.approx(7 / 8, abs=0.03)
