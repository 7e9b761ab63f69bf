"""Meshes of bodies are closed, and their mass properties those of the formulas."""

from collections import Counter

import numpy as np
import pytest

from debrisest.attitude import quaternion
from debrisest.vision.bodies import BODIES
from debrisest.vision.polyhedron import mass_properties
from debrisest.vision.solids import box, joined, revolved, turned


def test_a_box_anywhere_in_any_attitude_is_that_of_the_formula() -> None:
    sides, shift = np.array([2.0, 1.6, 1.2]), [300.0, -20.0, 5.0]
    turn = quaternion.to_matrix(quaternion.normalize(np.array([0.3, 0.5, -0.2, 0.7])))
    solid = turned(box((0, 0, 0), sides.tolist(), 1.0), turn, shift)
    found = mass_properties(solid.vertices, solid.triangles)
    squares = sides**2
    inertia = np.prod(sides) * (squares.sum() - squares) / 12.0
    assert found.volume == pytest.approx(np.prod(sides), rel=1e-12)
    np.testing.assert_allclose(found.centre, shift, atol=1e-10)
    np.testing.assert_allclose(found.inertia, turn @ np.diag(inertia) @ turn.T, atol=1e-9)


def test_a_solid_of_revolution_comes_to_the_cylinder_with_its_sections() -> None:
    radius, length = 1.3, 4.0
    profile = [(0.0, -2.0), (radius, -2.0), (radius, 2.0), (0.0, 2.0)]
    volume = np.pi * radius**2 * length
    across = volume * (radius**2 / 4 + length**2 / 12)
    for sections, share in ((32, 0.013), (128, 0.0009)):
        solid = revolved(profile, 1.0, sections)
        found = mass_properties(solid.vertices, solid.triangles)
        assert found.volume == pytest.approx(volume, rel=share)
        assert found.inertia[2, 2] == pytest.approx(volume * radius**2 / 2, rel=share)
        assert found.inertia[0, 0] == pytest.approx(across, rel=share)


def test_parts_add_up() -> None:
    first, second = box((0, 0, 0), (1, 1, 1), 1.0), box((2, 0, 0), (1, 2, 1), 1.0)
    both = joined(first, second)
    found = mass_properties(both.vertices, both.triangles)
    assert found.volume == pytest.approx(3.0)
    np.testing.assert_allclose(found.centre, [4.0 / 3.0, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_every_body_is_closed_outward_and_possible(name: str) -> None:
    solid = BODIES[name]()
    sides = solid.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    count = Counter(map(tuple, sides.tolist()))
    assert set(count.values()) == {1}
    assert all((end, start) in count for start, end in count)
    volume, _, inertia = mass_properties(solid.vertices, solid.triangles)
    moments = np.linalg.eigvalsh(inertia)
    assert volume > 0 and moments[0] > 0 and moments[2] < moments[0] + moments[1]
    assert len(solid.albedo) == len(solid.triangles)
