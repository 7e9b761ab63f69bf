"""A body laid onto a reference in axes of its own."""

import numpy as np
from scipy.spatial.transform import Rotation

from debrisest.reconstruction.alignment import align, surface_points
from debrisest.vision.polyhedron import mass_properties
from tests.reconstruction.solids import box, convex


def wedge():
    points = np.array([[0, 0, 0], [3, 0, 0], [0, 2, 0], [0, 0, 1], [3, 0, 0.4], [0, 2, 1]])
    return convex(points.astype(float))


def test_a_turned_and_moved_body_is_found():
    points, faces = wedge()
    turn = Rotation.from_rotvec([1.0, -2.0, 0.5]).as_matrix()
    moved = points @ turn.T + [5.0, -3.0, 2.0]
    found = align(moved, faces, points, faces)
    np.testing.assert_allclose(found.rotation @ turn, np.eye(3), atol=1e-3)
    np.testing.assert_allclose(moved @ found.rotation.T + found.shift, points, atol=3e-3)
    inertia = mass_properties(moved, faces).inertia
    np.testing.assert_allclose(
        found.inertia(inertia), mass_properties(points, faces).inertia, atol=1e-2
    )


def test_exchanged_axes_are_seen_where_moments_hide_them():
    points, faces = box((2.0, 1.6, 1.2))
    other, others = box((1.2, 2.0, 1.6))
    found = align(points, faces, other, others)
    assert found.distance < 0.05
    np.testing.assert_allclose(
        np.diag(found.inertia(mass_properties(points, faces).inertia)),
        np.diag(mass_properties(other, others).inertia),
        rtol=1e-4,
    )


def test_points_lie_on_the_surface_and_are_spread_by_area():
    points = surface_points(*box((2.0, 1.6, 1.2)), count=6000)
    face = np.abs(points) / [1.0, 0.8, 0.6]
    np.testing.assert_allclose(face.max(axis=1), 1.0, atol=1e-9)
    shares = np.bincount(face.argmax(axis=1)) / len(points)
    areas = np.array([1.6 * 1.2, 2.0 * 1.2, 2.0 * 1.6])
    np.testing.assert_allclose(shares, areas / areas.sum(), atol=0.01)
