"""A stereo pair whose images are rectified: no lens distortion, the same rows in both."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.recovery.triangulation import triangulate
from debrisest.sensors import pinhole
from debrisest.vision.camera import PinholeImage
from debrisest.vision.libraries import vision_library
from debrisest.vision.optical_flow import Image


class StereoPair(NamedTuple):
    """Two equal cameras side by side; points are in the axes of the rectified first one."""

    focal_px: float
    centre_px: Array
    """(2,)."""
    baseline: float
    """m."""

    @property
    def _shifts(self) -> Array:
        return np.array([[0.0, 0.0, 0.0], [-self.baseline, 0.0, 0.0]])

    def project(self, points: Array) -> Array:
        """Return the pixels (..., camera, 2) of points (..., 3), m; NaN for those behind."""
        local = points[..., None, :] + self._shifts
        pixels = pinhole.project(local, self.focal_px) + self.centre_px
        return np.where(local[..., 2:] > 0.0, pixels, np.nan)

    def derivative(self, points: Array) -> Array:
        """Return the derivative (..., camera, 2, 3) of `project`, px per m."""
        return pinhole.derivative(points[..., None, :] + self._shifts, self.focal_px)

    def points(self, pixels: Array) -> tuple[Array, Array]:
        """Return points (n, 3), m, of pixels (n, camera, 2), and their covariance for 1 px."""
        slopes = (np.swapaxes(pixels, 0, 1) - self.centre_px) / self.focal_px
        found = triangulate(np.broadcast_to(np.eye(3), (2, 3, 3)), self._shifts, slopes)
        return found.point, found.cofactor / self.focal_px**2


class Rectified(NamedTuple):
    """How the images of two cameras become those of a `StereoPair`."""

    pair: StereoPair
    rotation: Array
    """Turns vectors of the first camera into the rectified axes (3, 3)."""
    maps: list[tuple[Array, Array]]

    def images(self, frames: Image) -> list[Image]:
        """Return the rectified images of frames (camera, row, column)."""
        cv2 = vision_library("cv2")
        return [cv2.remap(frame, *each, cv2.INTER_LINEAR) for frame, each in zip(frames, self.maps)]


def rectified(left: PinholeImage, right: PinholeImage) -> Rectified:
    """Return the rectification of two cameras by Bouguet's method (OpenCV's)."""
    cv2 = vision_library("cv2")
    cameras = left, right
    turns = cv2.stereoRectify(
        left.matrix, left.distortion, right.matrix, right.distortion, left.size,
        right.rotation, right.translation[:, None], flags=cv2.CALIB_ZERO_DISPARITY, alpha=-1,
    )  # fmt: skip
    projection = turns[2]
    maps = [
        cv2.initUndistortRectifyMap(
            one.matrix, one.distortion, turn, projection[:, :3], left.size, cv2.CV_32FC1
        )
        for one, turn in zip(cameras, turns[:2])
    ]
    base = float(-turns[3][0, 3] / projection[0, 0])
    pair = StereoPair(float(projection[0, 0]), projection[:2, 2].copy(), base)
    return Rectified(pair, turns[0], maps)


def nearest(mask: BoolArray, maps: tuple[Array, Array]) -> BoolArray:
    """Return a mask (row, column) as an image is rectified."""
    cv2 = vision_library("cv2")
    return np.asarray(cv2.remap(mask.astype(np.uint8), *maps, cv2.INTER_NEAREST) > 0)
