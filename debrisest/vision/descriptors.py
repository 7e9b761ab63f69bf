"""What the surroundings of a point look like, as numbers (SIFT, Lowe 2004)."""

from typing import Any

import numpy as np

from debrisest.arrays import Array
from debrisest.vision.libraries import vision_library
from debrisest.vision.optical_flow import Image

_SIZE = 7.0


def described(image: Image, points: Array, angles: Array) -> Array:
    """Return descriptors (n, 128) of points (n, 2), px, upright at angles (n,), rad.

    An angle turns from the image's right to its bottom.
    """
    if not len(points):
        return np.zeros((0, 128))
    cv2: Any = vision_library("cv2")
    keypoints = [
        cv2.KeyPoint(float(u), float(v), _SIZE, float(np.degrees(angle) % 360.0))
        for (u, v), angle in zip(points, angles)
    ]
    return np.asarray(cv2.SIFT_create().compute(image, keypoints)[1], dtype=float)
