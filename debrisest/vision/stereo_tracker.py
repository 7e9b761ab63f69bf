"""Features of a turning body, followed through the images of a stereo pair.

Each frame: optical flow from where the motion so far leads to, the same points in the right image,
the pose on which the points of the body's map agree, and new corners where the image changes, which
may be points that are known already.
"""

from collections import Counter

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.vision.body_map import BodyMap
from debrisest.vision.contrast import evened
from debrisest.vision.followed import Followed, nothing
from debrisest.vision.moving import moving
from debrisest.vision.optical_flow import (
    APART,
    FORWARD_BACKWARD,
    MOST,
    Image,
    away_from,
    corners,
    followed,
)
from debrisest.vision.rigid_pose import RigidPose, fit, off
from debrisest.vision.stereo_match import matched, on_one_row
from debrisest.vision.stereo_pair import Rectified, nearest

EPIPOLAR = 1.0
"""Most difference of the rows, px."""
RIGID = 1.2
"""Most that a point may be off from the pose of all others, px."""
_STILL, _MOVES = 1.0, 3.0
"""A point that moves less, px, while the body moves it by more, stands still."""
_AGREE = 6
"""Points known again that must agree on a pose for it to be taken."""


class StereoTracker:
    """Takes the frames of a pair one by one, and keeps what has been found."""

    def __init__(self, rectified: Rectified, seed: int, body: BoolArray | None = None) -> None:
        """``body (time, row, column)`` is where the left image may have new points, if known."""
        self._body = body
        self.pair, self._rectified = rectified.pair, rectified
        self.map, self.counts, self.known_again = BodyMap(), Counter[str](), 0
        self.poses: list[RigidPose] = []
        self.found: list[Followed] = []
        self._draws = np.random.default_rng(seed)
        self.images: list[list[Image]] = []

    def take(self, frames: Image, epoch: int) -> Followed:
        """Return what is found in an epoch of ``frames (time, camera, row, column)``.

        Pixels are rectified.
        """
        images = [evened(image) for image in self._rectified.images(frames[epoch])]
        changes = nearest(moving(frames[:, 0], epoch, self._body), self._rectified.maps[0])
        now = self._follow(images) if self.images else nothing(2)
        now = self._renew(images, now, changes)
        self.images.append(images)
        self.found.append(now)
        return now

    def _follow(self, images: list[Image]) -> Followed:
        """Return those points of the frame before that are found again and agree."""
        before = self.found[-1]
        expected = self._expected()
        shown = self.pair.project(expected.of(self.map.points[before.numbers]))
        was = self.pair.project(self.poses[-1].of(self.map.points[before.numbers]))
        guess = np.where(np.isfinite(shown), before.pixels + shown - was, before.pixels)
        left, found = followed(
            self.images[-1][0], images[0], before.pixels[:, 0], guess[:, 0], FORWARD_BACKWARD
        )
        self.counts["lost by optical flow"] += int((~found).sum())
        guess_right = left + (guess[:, 1] - guess[:, 0])
        right, matches = followed(images[0], images[1], left, guess_right, FORWARD_BACKWARD)
        matches &= on_one_row(left, right, EPIPOLAR)
        self.counts["no match in the right image"] += int((found & ~matches).sum())
        still = np.linalg.norm(left - before.pixels[:, 0], axis=-1) < _STILL
        now = Followed(before.numbers, np.stack([left, right], axis=1))
        good = found & matches
        return self._agreeing(now.kept(good), still[good], expected)

    def _expected(self) -> RigidPose:
        return self.poses[-1].after(self.poses[-2]) if len(self.poses) > 1 else self.poses[-1]

    def _agreeing(self, now: Followed, still: BoolArray, expected: RigidPose) -> Followed:
        """Return the points that move with the body, and keep its pose."""
        body = self.map.points[now.numbers]
        found = fit(self.pair, body[~still], now.pixels[~still], RIGID, self._draws)
        if found is None:
            found = fit(self.pair, body, now.pixels, RIGID, self._draws)
        if found is None:
            self.counts["frames without a pose"] += 1
        pose = expected if found is None else found[0]
        moved = self.pair.project(pose.of(body)) - self.pair.project(self.poses[-1].of(body))
        background = still & (np.linalg.norm(moved[:, 0], axis=-1) > _MOVES)
        rigid = off(self.pair, pose, body, now.pixels) < RIGID
        self.counts["background that stands still"] += int((background & ~rigid).sum())
        self.counts["not rigid with the others"] += int((~background & ~rigid).sum())
        self.poses.append(pose)
        now = now.kept(rigid)
        self.map.improve(now.numbers, self.pair.points(now.pixels)[0], pose)
        return now

    def _renew(self, images: list[Image], now: Followed, changes: BoolArray) -> Followed:
        """Return the points and new ones, as far as there are too few."""
        free = changes & away_from(images[0].shape, now.pixels[:, 0])
        left = corners(images[0], free, APART, MOST - len(now.numbers))
        right, found = matched(images[0], images[1], left, FORWARD_BACKWARD)
        found &= on_one_row(left, right, EPIPOLAR)
        pixels = np.stack([left, right], axis=1)[found]
        self.counts["corners without a match"] += int((~found).sum())
        seen = self.pair.points(pixels)[0]
        if not self.poses:
            middle = np.median(seen, axis=0) if len(seen) else np.array([0.0, 0.0, 1.0])
            self.poses.append(RigidPose(np.eye(3), middle))
        numbers, now = self._known(images[0], pixels, now)
        fresh = numbers < 0
        numbers[fresh] = self.map.add(images[0], pixels[fresh, 0], seen[fresh], self.poses[-1])
        return now.and_more(numbers, pixels)

    def _known(self, image: Image, pixels: Array, now: Followed) -> tuple[IntArray, Followed]:
        """Return the numbers of new corners that are known already, else -1.

        If enough of them agree, the pose becomes that of the map, and the points that are followed
        are moved with it: what has drifted in a turn is undone.
        """
        lost = np.setdiff1d(np.arange(len(self.map.points)), now.numbers)
        numbers = self.map.known_again(image, pixels, self.pair, self.poses[-1], lost)
        known = np.flatnonzero(numbers >= 0)
        body = self.map.points[numbers[known]]
        found = fit(self.pair, body, pixels[known], RIGID, self._draws)
        if found is None or found[1].sum() < max(_AGREE, len(known) / 2):
            return np.full(len(pixels), -1), now
        pose, agree = found
        self.poses[-1] = pose
        self.map.anchor(now.numbers, self.pair.points(now.pixels)[0], pose)
        numbers[known[~agree]] = -1
        self.known_again += int(agree.sum())
        return numbers, now
