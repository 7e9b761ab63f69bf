"""Disparities to a small fraction of a pixel: least squares of the grey levels along the rows.

Semi-global matching prefers surfaces that face the camera, so that its disparities of tilted ones
are off by some tenths of a pixel, all to the same side; half the thickness of a thin panel. Each
pixel's disparity is therefore descended to where both images agree about it, as in optical flow
(Lucas and Kanade 1981). The second image is resampled at the disparities found so far, so that a
tilt costs nothing.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import BoolArray
from debrisest.vision.libraries import vision_library

_ROUNDS = 6
_NOISE_PX = 0.7
"""Smoothing of the images."""
_WINDOW_PX = 3.0
_SMOOTHED_PX = 2.0
"""Smoothing of the disparities to begin with, and between the rounds half of it."""
_JUMP_PX = 1.0
"""A disparity this far from its neighbours, or this far from where it began, is left out."""
_STEP_PX = 0.5
_TEXTURE = 1.0
"""Least mean square slope of the grey levels, per pixel."""

Image = NDArray[np.float32]


def refined(
    left: NDArray[np.uint8], right: NDArray[np.uint8], disparity: Image, known: BoolArray
) -> tuple[Image, BoolArray]:
    """Return the disparity (row, column), px, of the left image, and where it is still known.

    The right image shows at column ``u - disparity`` what the left one shows at ``u``.
    """
    cv2: Any = vision_library("cv2")
    one, other = (_smooth(image.astype(np.float32), _NOISE_PX) for image in (left, right))
    slope = cv2.Sobel(other, cv2.CV_32F, 1, 0, ksize=3, scale=1.0 / 8.0)
    found = _smooth_where(known, disparity, _SMOOTHED_PX)
    used = known & (np.abs(found - disparity) < _JUMP_PX)
    weight, began = used.astype(np.float32), found
    row, column = np.indices(one.shape, dtype=np.float32)
    texture = np.zeros_like(one)
    for _ in range(_ROUNDS):
        at = (column - found, row, cv2.INTER_CUBIC)
        there, rise = (cv2.remap(image, *at) for image in (other, slope))
        texture = _smooth(weight * rise**2, _WINDOW_PX)
        pull = _smooth(weight * rise * (there - one), _WINDOW_PX)
        step = np.clip(pull / (texture + _TEXTURE), -_STEP_PX, _STEP_PX)
        found = _smooth_where(used, found + step, 0.5 * _SMOOTHED_PX)
    return found, used & (np.abs(found - began) < _JUMP_PX) & (texture > _TEXTURE)


def _smooth(image: Image, width: float) -> Image:
    smoothed: Image = vision_library("cv2").GaussianBlur(image, (0, 0), width)
    return smoothed


def _smooth_where(known: BoolArray, values: Image, width: float) -> Image:
    """Return values smoothed over the known ones; zero where none is known."""
    weight = known.astype(np.float32)
    total = _smooth(np.where(known, values, 0.0).astype(np.float32), width)
    smoothed = total / np.maximum(_smooth(weight, width), np.float32(1e-3))
    return np.where(known, smoothed, np.float32(0.0)).astype(np.float32)
