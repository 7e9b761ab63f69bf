"""Corners of the left image that are found in the right one, on the same row."""

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.vision.libraries import vision_library
from debrisest.vision.optical_flow import Image, followed

_HALF = 9
"""Half a side of the square that is compared, px."""
_BAND = 2
"""Rows above and below."""
_ALIKE = 0.7
"""Least normalised correlation."""
_UNIQUE = 0.95
"""Most that a second place may have of the first one's correlation."""


def matched(left: Image, right: Image, points: Array, gate: float) -> tuple[Array, BoolArray]:
    """Return where points (n, 2) are in the right image, and which are found.

    Correlation over the whole row to the left, then optical flow to a part of a pixel with a
    forward-backward check. Places that are not unique are not found.
    """
    guess = np.array([_best(left, right, point) for point in points]).reshape(-1, 2)
    unique = np.isfinite(guess).all(axis=-1)
    there, found = followed(left, right, points, np.where(unique[:, None], guess, points), gate)
    near = np.linalg.norm(there - guess, axis=-1) < 3.0
    return there, found & unique & near


def on_one_row(left: Array, right: Array, gate: float) -> BoolArray:
    """Return which pairs of pixels (n, 2) meet the epipolar condition, right of infinity."""
    return np.asarray((np.abs(left[:, 1] - right[:, 1]) < gate) & (left[:, 0] - right[:, 0] > 0.5))


def _best(left: Image, right: Image, point: Array) -> Array:
    """Return the one place (2,) in the right image that looks like a point of the left; or NaN."""
    cv2 = vision_library("cv2")
    u, v = np.rint(point).astype(int)
    height, width = left.shape
    top, bottom = v - _HALF - _BAND, v + _HALF + _BAND + 1
    if not (_HALF <= u < width - _HALF and top >= 0 and bottom <= height):
        return np.full(2, np.nan)
    patch = left[v - _HALF : v + _HALF + 1, u - _HALF : u + _HALF + 1]
    strip = right[top:bottom, : u + _HALF + 1]
    alike = cv2.matchTemplate(strip, patch, cv2.TM_CCOEFF_NORMED)
    row, column = np.unravel_index(np.argmax(alike), alike.shape)
    best = alike[row, column]
    others = np.delete(alike, slice(max(column - 4, 0), column + 5), axis=1)
    if not best > _ALIKE or (others.size and others.max() > _UNIQUE * best):
        return np.full(2, np.nan)
    return np.asarray([column + _HALF, v - _BAND + row] + (point - [u, v]))
