"""Which silhouettes a body has, and what is told where its surroundings turn with it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("cv2")

from debrisest.arrays import Array
from debrisest.reconstruction.outline_choice import outlined
from debrisest.reconstruction.silhouettes import Reading
from debrisest.reconstruction.structure import Rig, Structure

COUNT, SIDE, AWAY = 24, 64, 4.0
RIG = Rig(
    np.array([[[60.0, 0.0, 31.5], [0.0, 60.0, 31.5], [0.0, 0.0, 1.0]]]),
    np.eye(3)[None],
    np.zeros((1, 3)),
)
FRAMES = np.zeros((COUNT, 1, SIDE, SIDE), dtype=np.uint8)


def structure(radius: float, points: int = 400) -> Structure:
    """Return a camera that goes once about points on a sphere of a radius."""
    angles = np.arange(COUNT) * 2.0 * np.pi / COUNT
    turns = Rotation.from_rotvec(np.outer(angles, [0.0, 1.0, 0.0])).as_matrix()
    shell = np.random.default_rng(5).normal(size=(points, 3))
    shell *= radius / np.linalg.norm(shell, axis=1, keepdims=True)
    shifts = np.tile([0.0, 0.0, AWAY], (COUNT, 1))
    return Structure(turns, shifts, shell, np.ones((COUNT, points), dtype=np.bool_), np.inf, 0.3)


def disc(radius_px: float) -> Array:
    v, u = np.indices((SIDE, SIDE)) - 31.5
    return np.tile(np.hypot(u, v) < radius_px, (COUNT, 1, 1, 1))


def both() -> Structure:
    """Return a body with a room about it."""
    inner, outer = structure(0.5, 60), structure(9.0)
    return inner._replace(
        points=np.concatenate([inner.points, outer.points]),
        seen=np.concatenate([inner.seen, outer.seen], axis=1),
    )


def test_a_body_in_its_surroundings_is_not_told_without_masks() -> None:
    reading, _ = outlined(FRAMES, [], RIG, structure(0.5), "either")
    assert 0.9 < reading.masks.mean() / disc(60.0 * 0.5 / AWAY).mean() < 1.3
    with pytest.raises(ValueError, match=r"went about a scene, \d+% of whose points .*--masks"):
        outlined(FRAMES, [], RIG, both(), "either")


def test_masks_tell_a_body_in_its_surroundings() -> None:
    drawn = Reading(disc(9.0), "drawn", given=True)
    reading, held = outlined(FRAMES, [drawn], RIG, both(), "either")
    assert reading is drawn
    assert held[:60].all()
    assert not held[60:].any()
