"""Mass properties of analytic solids, and meshes that are refused or mended."""

from importlib.util import find_spec

import numpy as np
import pytest

from debrisest.reconstruction.closed_mesh import closed_mesh
from debrisest.vision.polyhedron import mass_properties
from tests.reconstruction.solids import box, box_inertia, convex, inverted, together

SIDES = (2.0, 1.6, 1.2)
needs_manifold = pytest.mark.skipif(not find_spec("manifold3d"), reason="needs manifold3d")


def properties(solid):
    mesh = closed_mesh(*solid)
    return mass_properties(mesh.vertices, mesh.triangles)


def check(solid, volume, inertia, centre=(0.0, 0.0, 0.0)):
    found = properties(solid)
    np.testing.assert_allclose(found.volume, volume, rtol=1e-9)
    np.testing.assert_allclose(found.centre, centre, atol=1e-9 * max(1.0, np.abs(centre).max()))
    scale = np.abs(inertia).max()
    np.testing.assert_allclose(found.inertia, inertia, atol=1e-9 * scale)


def test_box_far_from_the_origin():
    check(box(SIDES, (3e3, -4e3, 5e3)), 3.84, box_inertia(SIDES, 3.84), (3e3, -4e3, 5e3))


def test_octahedron():
    points = np.concatenate([np.eye(3), -np.eye(3)])
    check(convex(points), 4 / 3, 4 / 3 / 5 * np.eye(3))


def test_regular_tetrahedron():
    points = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], dtype=float)
    check(convex(points), 8 / 3, 8 / 3 * 8 / 20 * np.eye(3))


def test_regular_prism():
    n, radius, height = 6, 0.7, 3.0
    angle = 2 * np.pi * np.arange(n) / n
    ring = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points = np.concatenate([np.c_[ring, np.full(n, z)] for z in (-height / 2, height / 2)])
    area = n / 2 * radius**2 * np.sin(2 * np.pi / n)
    volume = area * height
    polar = volume * radius**2 / 6 * (2 + np.cos(2 * np.pi / n))
    across = polar / 2 + volume * height**2 / 12
    check(convex(points), volume, np.diag([across, across, polar]))


def test_a_shell_wound_inwards_is_a_cavity():
    inner = (1.0, 0.8, 0.6)
    solid = together(box(SIDES), inverted(box(inner)))
    hollow = box_inertia(SIDES, 3.84) - box_inertia(inner, 0.48)
    check(solid, 3.84 - 0.48, hollow)
    check(inverted(solid), 3.84 - 0.48, hollow)


def refused(solid, words):
    with pytest.raises(ValueError, match=words):
        closed_mesh(*solid)


def mended(solid, words, volume):
    mesh = closed_mesh(*solid)
    (said,) = mesh.mended
    assert words in said
    assert mass_properties(mesh.vertices, mesh.triangles).volume == pytest.approx(volume, rel=1e-9)


def test_open_mesh_is_refused_with_the_number_of_edges():
    points, faces = box()
    refused((points, faces[1:]), "not closed: 3 edges")


def test_faces_wound_the_other_way_are_turned():
    points, faces = box()
    faces = faces.copy()
    faces[[2, 7]] = faces[[2, 7], ::-1]
    mended((points, faces), "2 faces wound the other way", 3.84)


def test_surface_through_itself_is_refused():
    points, faces = box()
    points = points.copy()
    corner = (points @ [1, 1, 1]).argmax()
    points[corner] *= -1.6
    refused((points, faces), "passes through itself: [0-9]+ pairs")


@needs_manifold
def test_overlapping_solids_are_united():
    shift = np.array([0.3, 0.3, 0.3])
    overlap = np.prod(np.array(SIDES) - shift)
    mended(together(box(), box(centre=shift)), "2 solids overlapping", 2 * 3.84 - overlap)


@needs_manifold
def test_a_solid_within_another_one_counts_once():
    mended(together(box(), box((0.5, 0.5, 0.5))), "1 solid overlapping", 3.84)


def test_a_solid_that_is_there_twice_counts_once():
    mended(together(box(), box()), "12 faces there more than once", 3.84)


def test_solids_that_share_an_edge_are_refused():
    refused(together(box(), box(centre=(2.0, 1.6, 0.0))), "1 edge has more than two faces")


def test_flat_meshes_are_refused():
    points, faces = box()
    refused((points * [1, 1, 0], faces), "flat")


def test_a_solid_inside_out_is_turned():
    mended(inverted(box()), "1 solid inside out", 3.84)


def test_a_surface_with_one_side_is_refused():
    projective = [
        *[(0, 1, 4), (0, 1, 5), (0, 2, 3), (0, 2, 5), (0, 3, 4)],
        *[(1, 2, 3), (1, 2, 4), (1, 3, 5), (2, 4, 5), (3, 4, 5)],
    ]
    points = np.random.default_rng(0).normal(size=(6, 3))
    refused((points, np.array(projective)), "one side only")


def test_no_faces_and_points_that_are_no_numbers_are_refused():
    points, faces = box()
    refused((points, faces[:0]), "no faces")
    refused((np.where(points > 0.7, np.nan, points), faces), "not finite")


def test_faces_without_area_are_removed():
    points, faces = box()
    mended((points, np.concatenate([faces, [[0, 0, 1]]])), "1 face without area", 3.84)


def test_a_cavity_outside_of_its_solid_is_turned_to_a_solid():
    """As it stands its moments are those of no body: the largest exceeds the sum of the others."""
    far = box((0.6, 0.6, 0.6), (5.0, 0.0, 0.0))
    mended(together(box(), inverted(far)), "1 solid inside out", 3.84 + 0.216)
