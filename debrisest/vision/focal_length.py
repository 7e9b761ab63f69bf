"""A first focal length of a camera that was not calibrated: from EXIF, or a field of view."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array

_CAMERA_TAGS, _FOCAL_35MM = 0x8769, 0xA405
_DIAGONAL_35MM = np.hypot(36.0, 24.0)
_EXIF_SPREAD, _VIEW_SPREAD, _USUAL_SPREAD = 0.05, 0.1, 0.3
USUAL_VIEW_DEG = 50.0
"""Across the longer side: that of cameras of phones, and of lenses of 28 to 50 mm, is 40 to 65."""


class FirstFocal(NamedTuple):
    """Where a calibration from images begins."""

    px: float
    spread: float
    """1-sigma, of the focal length."""
    source: str
    """Where it comes from, in words."""

    def matrix(self, size: tuple[int, int]) -> Array:
        """Return the camera matrix (3, 3) whose principal point is the middle of an image."""
        (width, height), focal = size, self.px
        middle = 0.5 * (width - 1), 0.5 * (height - 1)
        return np.array([[focal, 0.0, middle[0]], [0.0, focal, middle[1]], [0.0, 0.0, 1.0]])


def first_focal(
    path: Path, size: tuple[int, int], field_of_view_deg: float | None = None
) -> FirstFocal:
    """Return a first focal length for images of a size (width and height, px).

    ``path`` is the first image, whose EXIF may tell that of a camera for 35 mm film with the same
    diagonal field of view; ``field_of_view_deg``, across the longer side, goes before it.
    """
    if field_of_view_deg is not None:
        told = f"a field of view of {field_of_view_deg:g} deg, as given"
        return FirstFocal(_of_view(size, field_of_view_deg), _VIEW_SPREAD, told)
    if (focal := _focal_35mm(path)) is not None:
        px = focal / _DIAGONAL_35MM * float(np.hypot(*size))
        return FirstFocal(px, _EXIF_SPREAD, f"EXIF ({focal:g} mm for 35 mm film)")
    told = f"a field of view of {USUAL_VIEW_DEG:g} deg, taken since nothing tells it"
    return FirstFocal(_of_view(size, USUAL_VIEW_DEG), _USUAL_SPREAD, told)


def _of_view(size: tuple[int, int], degrees: float) -> float:
    return float(0.5 * max(size) / np.tan(np.radians(0.5 * degrees)))


def _focal_35mm(path: Path) -> float | None:
    """Return the focal length, mm, that EXIF tells for 35 mm film, if it does."""
    from PIL import Image

    try:
        with Image.open(path) as image:
            focal = float(image.getexif().get_ifd(_CAMERA_TAGS).get(_FOCAL_35MM, 0.0))
    except (OSError, ValueError, TypeError, SyntaxError):
        return None
    return focal if np.isfinite(focal) and focal > 0.0 else None
