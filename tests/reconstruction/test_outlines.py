"""Outlines by the cloud: what hangs together, and its hull in images."""

import numpy as np
import pytest

pytest.importorskip("cv2")

from debrisest.reconstruction.outlines import main_part, outlines
from debrisest.reconstruction.structure import Structure

MATRIX = np.array([[100.0, 0.0, 50.0], [0.0, 100.0, 40.0], [0.0, 0.0, 1.0]])


def structure(points, seen=3):
    rotation, translation = np.tile(np.eye(3), (4, 1, 1)), np.tile([0.0, 0.0, 10.0], (4, 1))
    translation[3] = np.nan
    shown = np.zeros((4, len(points)), dtype=bool)
    shown[:seen] = True
    return Structure(rotation, translation, points, shown, np.inf, 0.5)


def test_points_far_from_the_others_are_not_the_body():
    rng = np.random.default_rng(1)
    body, hand = rng.uniform(-1, 1, (300, 3)), rng.uniform(-1, 1, (100, 3))
    hand[:, 0] += 6.0
    found = main_part(structure(np.concatenate([body, hand])))
    assert found[:300].mean() > 0.95
    assert not found[300:].any()


def test_points_that_two_images_see_are_too_few():
    with pytest.raises(ValueError, match="0 points that three images see"):
        main_part(structure(np.zeros((50, 3)), seen=2))


def test_the_outline_is_the_hull_of_the_cloud():
    corners = np.array([[x, y, 0.0] for x in (-2.0, 2.0) for y in (-1.0, 1.0)])
    found = outlines(structure(corners), MATRIX, (80, 100))
    rows, columns = np.nonzero(found[0])
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (30, 50, 30, 70)
    assert found[0].sum() == 21 * 41
    assert not found[3].any()
