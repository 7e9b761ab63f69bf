"""Images as cameras without distortion would have taken them."""

import numpy as np

from debrisest.arrays import Array
from debrisest.reconstruction.silhouettes import Frames
from debrisest.vision.libraries import vision_library


def undistorted(frames: Frames, matrix: Array, distortion: Array) -> Frames:
    """Return images (time, camera, row, column) with the same camera matrices.

    ``matrix (camera, 3, 3)``, px; ``distortion (camera, 5)``, OpenCV's k1, k2, p1, p2, k3.
    """
    if not distortion.any():
        return frames
    cv2 = vision_library("cv2")
    flat = [
        [cv2.undistort(image, *camera) for image, *camera in zip(images, matrix, distortion)]
        for images in frames
    ]
    return np.asarray(flat, dtype=np.uint8)
