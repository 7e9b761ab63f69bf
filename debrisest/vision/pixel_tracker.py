"""Features of a turning body, followed through the images of one camera that stands still.

A rigid body and one camera leave one condition on each pair of images, the epipolar one; what does
not move while most does is background.
"""

from collections import Counter

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.vision.contrast import evened
from debrisest.vision.followed import Followed, nothing
from debrisest.vision.libraries import vision_library
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

_EPIPOLAR = 1.0
"""Most distance from the epipolar line, px."""
_STILL = 0.5
"""Most that background moves, px."""
_FEWEST = 12
"""Points that the epipolar condition is found from."""


class PixelTracker:
    """Takes the frames of a camera one by one, and keeps what has been found."""

    def __init__(self, body: BoolArray | None = None) -> None:
        """``body (time, row, column)`` is where new points may be, if that is known."""
        self._body = body
        self.counts, self.points = Counter[str](), 0
        self.found: list[Followed] = []
        self._before: Image | None = None

    def take(self, frames: Image, epoch: int) -> None:
        """Take an epoch of ``frames (time, row, column)``."""
        image = evened(frames[epoch])
        now = nothing() if self._before is None else self._follow(self._before, image)
        free = moving(frames, epoch, self._body) & away_from(image.shape, now.pixels)
        new = corners(image, free, APART, MOST - len(now.numbers))
        numbers = np.arange(self.points, self.points + len(new))
        self.points += len(new)
        self._before = image
        self.found.append(now.and_more(numbers, new))

    def _follow(self, before: Image, image: Image) -> Followed:
        last = self.found[-1]
        there, found = followed(before, image, last.pixels, last.pixels, FORWARD_BACKWARD)
        self.counts["lost by optical flow"] += int((~found).sum())
        still = found & (np.linalg.norm(there - last.pixels, axis=-1) < _STILL)
        self.counts["background that stands still"] += int(still.sum())
        moves = found & ~still
        moves[moves] = _on_epipolar_lines(last.pixels[moves], there[moves])
        self.counts["not rigid with the others"] += int((found & ~still & ~moves).sum())
        return Followed(last.numbers, there).kept(moves)


def _on_epipolar_lines(before: Array, after: Array) -> BoolArray:
    """Return which pairs of pixels (n, 2) one rigid motion explains; none where it is not found."""
    if len(before) < _FEWEST:
        return np.zeros(len(before), dtype=bool)
    cv2 = vision_library("cv2")
    cv2.setRNGSeed(0)
    found = cv2.findFundamentalMat(before, after, cv2.FM_RANSAC, _EPIPOLAR, 0.999)[1]
    return np.zeros(len(before), bool) if found is None else np.asarray(found[:, 0] > 0)
