"""A structure laid onto places of the camera that are given."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from debrisest.reconstruction.given_places import laid_onto
from debrisest.reconstruction.structure import Structure

SCALE, TURN = 2.5, Rotation.from_rotvec([0.4, -1.0, 2.0]).as_matrix()
SHIFT = np.array([3.0, -1.0, 0.5])


def given(count=12):
    """Places on a circle, as of a turntable, and points in axes in which they are given."""
    about = Rotation.from_euler("y", np.linspace(0.0, 300.0, count)[:, None], degrees=True)
    rotation = (Rotation.from_euler("x", 20.0, degrees=True) * about).as_matrix()
    return rotation, np.tile([0.0, 0.1, 6.0], (count, 1))


def found(rotation, translation, points):
    """The same as structure from motion finds it: in axes and a scale of its own."""
    turned = rotation @ TURN
    shift = (translation + rotation @ SHIFT) / SCALE
    seen = np.ones((len(rotation), len(points)), dtype=bool)
    return Structure(turned, shift, (points - SHIFT) @ TURN / SCALE, seen, np.inf, 0.4)


def test_the_given_places_give_scale_and_axes():
    points = np.random.default_rng(1).normal(size=(50, 3))
    rotation, translation = given()
    laid = laid_onto(found(rotation, translation, points), rotation, translation)
    np.testing.assert_allclose(laid.points, points, atol=1e-10)
    np.testing.assert_allclose(laid.rotation, rotation, atol=1e-10)
    np.testing.assert_allclose(laid.translation, translation, atol=1e-10)
    assert laid.scale_sigma < 1e-10


def test_an_image_without_a_place_stays_without():
    rotation, translation = given()
    lost = found(rotation, translation, np.eye(3))
    lost.rotation[3], lost.translation[3] = np.nan, np.nan
    laid = laid_onto(lost, rotation, translation)
    assert np.isnan(laid.translation[3]).all()
    np.testing.assert_allclose(laid.points, np.eye(3), atol=1e-10)


def test_the_scale_is_as_uncertain_as_the_places_differ():
    rng, (rotation, translation) = np.random.default_rng(2), given(40)
    structure = found(rotation, translation, np.eye(3))
    errors = []
    for _ in range(200):
        noisy = translation + rng.normal(0.0, 0.02, translation.shape)
        laid = laid_onto(structure, rotation, noisy)
        size = np.linalg.norm(laid.points[0] - laid.points[1]) / np.sqrt(2.0)
        errors.append((size - 1.0) / laid.scale_sigma)
    assert 0.3 < np.std(errors) < 1.5


def test_places_of_other_images_are_refused():
    rotation, translation = given()
    structure = found(rotation, translation, np.eye(3))
    with pytest.raises(ValueError, match="differ from those found"):
        laid_onto(structure, rotation[::-1], translation + np.arange(12.0)[:, None])
