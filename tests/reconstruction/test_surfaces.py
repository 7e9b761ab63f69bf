"""Surfaces through clouds and depth images made from analytic bodies."""

import numpy as np
import pytest

from debrisest.reconstruction import fusion
from debrisest.reconstruction.closed_mesh import closed_mesh
from debrisest.reconstruction.dense_cloud import OrientedCloud, dense_cloud
from debrisest.reconstruction.depth import DepthView, View, _pairs
from debrisest.reconstruction.normals import facing_surface
from debrisest.reconstruction.oriented import oriented
from debrisest.reconstruction.poisson import poisson_mesh
from debrisest.reconstruction.structure import Lens, Rig, Structure
from debrisest.vision.polyhedron import mass_properties

RADIUS, RANGE, FOCAL = 1.0, 12.0, 400.0
SHAPE = (120, 120)
MATRIX = np.array([[FOCAL, 0, 59.5], [0, FOCAL, 59.5], [0, 0, 1]])


def directions(count):
    index = np.arange(count) + 0.5
    height, turn = 1 - 2 * index / count, np.pi * (1 + 5**0.5) * index
    flat = np.sqrt(1 - height**2)
    return np.stack([flat * np.cos(turn), flat * np.sin(turn), height], axis=1)


def looking(direction):
    """Axes r to those of a camera that looks against a direction."""
    ahead = -direction
    right = np.cross(ahead, [0.3, 0.5, 0.8])
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(ahead, right), ahead])


def sphere_depth():
    """Distance along z and silhouette of a sphere in front of a camera, in closed form."""
    v, u = np.indices(SHAPE)
    rays = np.stack([(u - 59.5) / FOCAL, (v - 59.5) / FOCAL, np.ones(SHAPE)], axis=-1)
    square = (rays**2).sum(-1)
    root = RANGE**2 - square * (RANGE**2 - RADIUS**2)
    inside = root > 0
    depth = np.where(inside, (RANGE - np.sqrt(np.maximum(root, 0))) / square, np.nan)
    return depth.astype(np.float32), inside


def sphere_views(count=40):
    depth, mask = sphere_depth()
    turns = np.stack([looking(direction) for direction in directions(count)])
    shift = np.tile([0.0, 0.0, RANGE], (count, 1))
    views = [DepthView(View(MATRIX, turn, shift[0]), depth) for turn in turns]
    points = RADIUS * directions(500)
    structure = Structure(turns, shift, points, np.ones((count, 500), dtype=bool), 0.0, 0.0)
    return views, np.stack([mask] * count), structure


def check_sphere(vertices, triangles, within):
    mesh = closed_mesh(vertices, triangles)
    found = mass_properties(mesh.vertices, mesh.triangles)
    volume = 4 / 3 * np.pi * RADIUS**3
    assert found.volume == pytest.approx(volume, rel=within)
    moment = 2 / 5 * volume * RADIUS**2
    np.testing.assert_allclose(found.inertia, moment * np.eye(3), atol=2 * within * moment)


def test_silhouettes_and_depth_fuse_to_a_sphere():
    pytest.importorskip("cv2")
    pytest.importorskip("skimage")
    views, masks, structure = sphere_views()
    grid = fusion.grid_about(structure.points, 0.06)
    outside = fusion.outside_silhouettes(grid.points, masks, MATRIX, structure)
    check_sphere(*fusion.fused_mesh(grid, outside, views), within=0.04)


def plate_depth(turn, half):
    """Distance along z of a box about the origin, in closed form: where rays enter its slabs."""
    v, u = np.indices(SHAPE)
    rays = np.stack([(u - 59.5) / FOCAL, (v - 59.5) / FOCAL, np.ones(SHAPE)], axis=-1) @ turn
    origin = -RANGE * turn[2]
    with np.errstate(divide="ignore"):
        ends = np.stack([(side * half - origin) / rays for side in (-1, 1)])
    enter, leave = ends.min(axis=0).max(axis=-1), ends.max(axis=0).min(axis=-1)
    return np.where(enter < leave, enter, np.nan).astype(np.float32), enter < leave


def test_a_panel_thinner_than_the_reach_keeps_its_two_sides():
    pytest.importorskip("cv2")
    pytest.importorskip("skimage")
    half = np.array([1.2, 0.9, 0.06])
    turns = np.stack([looking(direction) for direction in directions(60)])
    depths, masks = zip(*(plate_depth(turn, half) for turn in turns))
    shift = np.array([0.0, 0.0, RANGE])
    views = [DepthView(View(MATRIX, *at), depth) for *at, depth in zip(turns, [shift] * 60, depths)]
    corners = half * (np.indices((2, 2, 2)).reshape(3, -1).T * 2 - 1)
    seen = np.ones((60, 8), dtype=bool)
    structure = Structure(turns, np.tile(shift, (60, 1)), corners, seen, 0.0, 0.0)
    grid = fusion.grid_about(corners, 0.06)

    def outside(points):
        return fusion.outside_silhouettes(points, np.stack(masks), MATRIX, structure)

    mesh = closed_mesh(*fusion.fused_mesh(grid, fusion.near(grid, outside), views))
    found = mass_properties(mesh.vertices, mesh.triangles)
    assert found.volume == pytest.approx(8 * half.prod(), rel=0.12)


def test_a_grid_asked_near_the_body_only_has_the_same_surface():
    grid = fusion.Grid(np.full(3, -1.5), 0.05, (61, 58, 60))

    def outside(points):
        return (np.linalg.norm(points, axis=1) - 1.0).astype(np.float32)

    whole, part = outside(grid.points), fusion.near(grid, outside)
    np.testing.assert_array_equal(part < 0, whole < 0)
    close = np.abs(whole) < 0.1
    np.testing.assert_array_equal(part[close], whole[close])


def test_silhouettes_hold_the_sphere_and_not_much_more():
    pytest.importorskip("cv2")
    _, masks, structure = sphere_views()
    radii = np.array([0.0, 0.9, 1.15, 1.5])
    points = np.repeat(radii, 300)[:, None] * np.tile(directions(300), (4, 1))
    outside = fusion.outside_silhouettes(points, masks, MATRIX, structure).reshape(4, 300)
    assert (outside[:2] < 0).all()
    assert (outside[2:] > 0).all()


def test_what_no_image_shows_is_outside_unless_the_body_leaves_the_image():
    pytest.importorskip("cv2")
    _, masks, structure = sphere_views()
    far = 4.0 * directions(50)
    assert (fusion.outside_silhouettes(far, masks, MATRIX, structure) > 0).all()
    cut = masks.copy()
    cut[:, 60, 60:] = True
    assert (fusion.outside_silhouettes(far, cut, MATRIX, structure) < 0).any()


def test_depth_images_become_a_cloud_whose_poisson_surface_is_the_sphere():
    pytest.importorskip("cv2")
    pytest.importorskip("pycolmap")
    pytest.importorskip("trimesh")
    cloud = dense_cloud(sphere_views()[0], 0.06)
    radius = np.linalg.norm(cloud.points, axis=1)
    np.testing.assert_allclose(radius, RADIUS, atol=0.03)
    assert (cloud.normals * cloud.points).sum(1).min() > 0.9
    check_sphere(*poisson_mesh(cloud, 5), within=0.04)


def test_a_cloud_without_normals_is_taken_to_face_outwards():
    points = directions(2000) * [2.0, 1.0, 1.5]
    found = oriented(points)
    outward = points / np.array([2.0, 1.0, 1.5]) ** 2
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    assert np.median((found.normals * outward).sum(1)) > 0.99
    with pytest.raises(ValueError, match="too thin"):
        oriented(points[:50])


def test_depth_of_too_few_points_is_refused():
    pytest.importorskip("cv2")
    nothing = np.full(SHAPE, np.nan, dtype=np.float32)
    empty = [DepthView(View(MATRIX, np.eye(3), np.zeros(3)), nothing)]
    with pytest.raises(ValueError, match="too little depth"):
        dense_cloud(empty, 0.1)


def test_points_of_a_plane_close_to_no_body():
    pytest.importorskip("pycolmap")
    pytest.importorskip("trimesh")
    rng = np.random.default_rng(1)
    points = rng.uniform(size=(500, 3)) * [1, 1, 0]
    cloud = OrientedCloud(points, np.tile([0.0, 0.0, 1.0], (500, 1)))
    with pytest.raises(ValueError):
        closed_mesh(*poisson_mesh(cloud, 4))


def test_smoothing_takes_little_from_a_surface_that_bends():
    """One average with a sigma of two pixels takes half its square times both curvatures."""
    depth, _ = sphere_depth()
    surface = facing_surface(DepthView(View(MATRIX, np.eye(3), np.zeros(3)), depth))
    radius = np.linalg.norm(surface.points - [0.0, 0.0, RANGE], axis=-1)
    faces = surface.cosine > 0.8
    assert faces.sum() > 1000
    once = (2.0 * RANGE / FOCAL) ** 2 / RADIUS
    assert abs(np.median(radius[faces]) - RADIUS) < 0.2 * once


def test_an_image_is_paired_with_the_next_and_of_an_unknown_camera_with_the_one_before_too():
    turns = np.stack([looking(np.array([np.cos(a), np.sin(a), 0.0])) for a in 0.14 * np.arange(4)])
    shift = np.tile([0.0, 0.0, RANGE], (4, 1))
    shift[2] = np.nan
    structure = Structure(turns, shift, np.zeros((1, 3)), np.ones((4, 1), dtype=bool), 0.0, 0.0)
    rig = Rig(MATRIX[None], np.eye(3)[None], np.zeros((1, 3)))

    def pairs(structure):
        return [(first[0], second[0]) for _, (first, second) in _pairs(rig, structure)]

    assert pairs(structure) == [(0, 1), (1, 3)]
    photographed = structure._replace(lens=Lens(MATRIX, np.zeros(5), 0.01))
    assert pairs(photographed) == [(0, 1), (1, 0), (1, 3), (3, 1)]
