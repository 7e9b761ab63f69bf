"""Pinhole cameras with lenses: z ahead, x right, y down; pixels count from the corner."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.sensors.distortion import distorted, undistorted


class PinholeImage(NamedTuple):
    """A camera and its place: ``x_c = rotation x_0 + translation`` of points in the first one's."""

    size: tuple[int, int]
    """Width and height, px."""
    matrix: Array
    """Camera matrix (3, 3), px; the middle of the first pixel is (0, 0), as OpenCV has it."""
    distortion: Array
    """OpenCV's ``k1, k2, p1, p2, k3`` (5,)."""
    rotation: Array = np.eye(3)
    translation: Array = np.zeros(3)

    def project(self, points: Array) -> Array:
        """Return the pixels (..., 2) of points (..., 3), m, in the first camera's axes."""
        seen = points @ self.rotation.T + self.translation
        slopes = distorted(seen[..., :2] / seen[..., 2:], self.distortion.tolist())
        focal, centre = np.diag(self.matrix)[:2], self.matrix[:2, 2]
        return np.asarray(slopes * focal + centre)

    def slopes(self, pixels: Array) -> Array:
        """Return x/z and y/z (..., 2) of what is seen at pixels (..., 2), in its own axes."""
        focal, centre = np.diag(self.matrix)[:2], self.matrix[:2, 2]
        return undistorted((pixels - centre) / focal, self.distortion.tolist())

    @property
    def position(self) -> Array:
        """Return where the camera is in the first one's axes (3,)."""
        return np.asarray(-self.rotation.T @ self.translation)

    def rays(self, offset: Array) -> Array:
        """Return directions (height, width, 3), first camera's axes, of points of the pixels.

        ``offset (2,)`` is the point's, from the middle of the pixel.
        """
        width, height = self.size
        u, v = np.meshgrid(np.arange(width), np.arange(height))
        slopes = self.slopes(np.stack([u, v], axis=-1) + offset)
        ahead = np.concatenate([slopes, np.ones((height, width, 1))], axis=-1)
        return np.asarray(ahead @ self.rotation)
