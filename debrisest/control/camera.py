"""What a satellite's camera shows of the target, and what the controller is given of it."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.attitude import euler
from debrisest.sensors import pinhole


class Camera(NamedTuple):
    """The image of each satellite of a run."""

    scale: Array
    """Focal length in pixels, (run, 1)."""
    half_size: Array
    """(run, 1, 2), pixels."""
    margin: float
    """Distance from an edge, in pixels, within which the target is about to leave."""
    rounded: bool
    """Whether pixels are measured as whole numbers."""

    def shown(self, point_o: Array, angles: Array) -> tuple[Array, BoolArray]:
        """Pixel (run, satellite, 2) of a point in local orbital axes, and where it is in view.

        ``angles (run, satellite, 3)`` are those of the body.
        """
        point_b = (point_o[..., None, :] @ euler.to_matrix(angles))[..., 0, :]
        point_c = point_b @ pinhole.BODY_TO_CAMERA.T
        pixel = pinhole.project(point_c, self.scale)
        return pixel, pinhole.in_view(point_c, pixel, self.half_size)

    def measured(self, shown: tuple[Array, BoolArray]) -> Array:
        """The pixel as the controller sees it, NaN out of view."""
        pixel, visible = shown
        pixel = np.rint(pixel) if self.rounded else pixel
        return np.where(visible[..., None], pixel, np.nan)

    def is_left(self, pixel: Array, seen: Array) -> BoolArray:
        """Runs in which a satellite that saw the target sees it at the edge or not at all.

        ``pixel`` and the one ``seen`` last are as measured.
        """
        inside = (np.abs(pixel) < self.half_size - self.margin).all(-1)
        return np.asarray((~np.isnan(seen).any(-1) & ~inside).any(-1))
