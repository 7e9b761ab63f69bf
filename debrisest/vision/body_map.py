"""The points of a body that have been seen, and how they are known again after a turn."""

from dataclasses import dataclass, field

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.vision.descriptors import described
from debrisest.vision.optical_flow import Image
from debrisest.vision.rigid_pose import RigidPose
from debrisest.vision.stereo_pair import StereoPair

_SEARCH = 15.0
"""Pixels about where the map has a point."""
_SAME_SIDE = np.cos(np.radians(40.0))
"""Between the directions from which a point was seen and is seen."""
_ALIKE, _UNIQUE = 260.0, 0.8
"""Most distance of descriptors (they have a norm of 512), and its ratio to the second one's."""


@dataclass
class BodyMap:
    """Points by their number, in axes that are fixed in the body."""

    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    """(point, 3), m: the mean over all frames in which they were seen."""
    counts: Array = field(default_factory=lambda: np.zeros(0))
    """Frames of which it is the mean (point,)."""
    looks: Array = field(default_factory=lambda: np.zeros((0, 128)))
    """Descriptors at the first sight (point, 128)."""
    turns: Array = field(default_factory=lambda: np.zeros((0, 3, 3)))
    """Body to camera axes at the first sight (point, 3, 3)."""
    views: Array = field(default_factory=lambda: np.zeros((0, 3)))
    """Direction from the body to the camera then, body axes (point, 3)."""

    def add(self, image: Image, pixels: Array, seen: Array, pose: RigidPose) -> IntArray:
        """Add points seen (n, 3), m, camera axes, at pixels (n, 2); return their numbers."""
        count, first = len(seen), len(self.points)
        self.points = np.concatenate([self.points, pose.back(seen)])
        self.counts = np.concatenate([self.counts, np.ones(count)])
        self.looks = np.concatenate([self.looks, described(image, pixels, np.zeros(count))])
        self.turns = np.concatenate([self.turns, np.broadcast_to(pose.rotation, (count, 3, 3))])
        self.views = np.concatenate([self.views, _view(seen, pose)])
        return np.arange(first, first + count)

    def improve(self, numbers: IntArray, seen: Array, pose: RigidPose) -> None:
        """Take points that are seen once more (n, 3), camera axes, into the mean."""
        self.counts[numbers] += 1.0
        change = (pose.back(seen) - self.points[numbers]) / self.counts[numbers, None]
        self.points[numbers] += change

    def anchor(self, numbers: IntArray, seen: Array, pose: RigidPose) -> None:
        """Forget where points were, for where they are seen (n, 3) now, camera axes."""
        self.points[numbers], self.counts[numbers] = pose.back(seen), 1.0

    def known_again(
        self,
        image: Image,
        pixels: Array,
        pair: StereoPair,
        pose: RigidPose,
        lost: IntArray,
    ) -> IntArray:
        """Return which of the ``lost`` numbers points at pixels (n, camera, 2) are; -1 if none.

        They must be near where the map has them, seen from the same side, look alike, and be
        each other's best.
        """
        place, same_side = pose.of(self.points[lost]), self._same_side(lost, pose)
        shown = pair.project(place)
        apart = np.linalg.norm(pixels[:, None] - shown, axis=-1).max(axis=-1)
        near = (apart < _SEARCH) & same_side
        distance = np.where(near, 0.0, np.inf)
        corner, point = np.nonzero(near)
        looks = described(image, pixels[corner, 0], self._angles(lost[point], pose))
        distance[corner, point] = np.linalg.norm(looks - self.looks[lost[point]], axis=-1)
        return _mutual(distance, lost)

    def _same_side(self, numbers: IntArray, pose: RigidPose) -> Array:
        now = _view(pose.of(self.points[numbers]), pose)
        return np.asarray(np.sum(now * self.views[numbers], axis=-1) > _SAME_SIDE)

    def _angles(self, numbers: IntArray, pose: RigidPose) -> Array:
        """Return where the image's right at the first sight points to now (n,), rad."""
        right = np.einsum("ij,nj->ni", pose.rotation, self.turns[numbers, 0])
        return np.asarray(np.arctan2(right[:, 1], right[:, 0]))


def _view(seen: Array, pose: RigidPose) -> Array:
    """Return the directions (n, 3), body axes, from points (n, 3), camera axes, to the camera."""
    away = seen / np.linalg.norm(seen, axis=-1, keepdims=True)
    return np.asarray(-away @ pose.rotation)


def _mutual(distance: Array, lost: IntArray) -> IntArray:
    """Return the number that each corner (row) is best for, where it is alike and unique."""
    if not distance.size:
        return np.full(len(distance), -1)
    best = distance.argmin(axis=1)
    corner = np.arange(len(distance))
    first = distance[corner, best]
    rest = distance.copy()
    rest[corner, best] = np.inf
    alone = first < _UNIQUE * rest.min(axis=1)
    mutual = distance[:, best].argmin(axis=0) == corner
    return np.where((first < _ALIKE) & alone & mutual, lost[best], -1)
