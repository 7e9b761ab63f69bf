"""Points that are followed from one image to another, and corners to follow."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray
from debrisest.vision.libraries import vision_library

Image = NDArray[np.uint8]
FORWARD_BACKWARD = 0.5
"""Most that a point may be off, px, when it is followed there and back."""
MOST, APART = 400, 8.0
"""Features that are followed at a time, and their least distance, px."""
_WINDOW, _LEVELS = 13, 3
_QUALITY = 0.01
"""Of the best corner's strength, the least that counts."""


def corners(image: Image, where: BoolArray, apart: float, most: int) -> Array:
    """Return the strongest corners (n, 2), u and v, px, of Shi and Tomasi within a mask."""
    cv2 = vision_library("cv2")
    mask = where.astype(np.uint8)
    found = cv2.goodFeaturesToTrack(image, most, _QUALITY, apart, mask=mask) if most > 0 else None
    if found is None:
        return np.zeros((0, 2))
    fine = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 20, 0.01)
    refined = cv2.cornerSubPix(image, found.reshape(-1, 1, 2).copy(), (3, 3), (-1, -1), fine)
    moved = np.linalg.norm(refined - found.reshape(-1, 1, 2), axis=-1) < 1.5
    return np.asarray(np.where(moved, refined[:, 0], found.reshape(-1, 2)), dtype=float)


def followed(
    before: Image, after: Image, points: Array, guess: Array, gate: float
) -> tuple[Array, BoolArray]:
    """Return where points (n, 2) of an image are in another, and which are found.

    Lucas and Kanade in pyramids, from a ``guess (n, 2)``; found are those that come back to less
    than ``gate`` px from where they were (forward and backward).
    """
    if not len(points):
        return points, np.zeros(0, dtype=bool)
    there, found = _flow(before, after, points, guess)
    back, returned = _flow(after, before, there, points)
    near = np.linalg.norm(back - points, axis=-1) < gate
    height, width = after.shape
    inside = (there >= 0).all(axis=-1) & (there <= [width - 1, height - 1]).all(axis=-1)
    return there, found & returned & near & inside


def _flow(before: Image, after: Image, points: Array, guess: Array) -> tuple[Array, BoolArray]:
    cv2: Any = vision_library("cv2")
    there, found, _ = cv2.calcOpticalFlowPyrLK(
        before,
        after,
        points.astype(np.float32)[:, None],
        guess.astype(np.float32)[:, None].copy(),
        winSize=(_WINDOW, _WINDOW),
        maxLevel=_LEVELS,
        criteria=(cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 30, 0.01),
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )
    return there[:, 0].astype(float), found[:, 0].astype(bool)


def away_from(shape: tuple[int, ...], pixels: Array) -> BoolArray:
    """Return where an image has none of the points (n, 2) near."""
    free = np.ones(shape, dtype=bool)
    reach = int(APART)
    for u, v in np.rint(pixels).astype(int):
        free[max(v - reach, 0) : v + reach + 1, max(u - reach, 0) : u + reach + 1] = False
    return free
