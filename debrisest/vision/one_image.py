"""One image in a file: read whole or refused, as its camera was held, as wide as is wanted."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.errors import UserError
from debrisest.files import content
from debrisest.vision.libraries import vision_library

_ORIENTATION, _TURNED = 0x0112, (".jpg", ".jpeg", ".tif", ".tiff", ".webp")
"""EXIF's tag of how a camera was held, and the files that have it."""


def image_of(path: Path, flag: int = 0) -> NDArray[np.uint8]:
    """Return an image, grey unless OpenCV's flag of reading says otherwise.

    Raises `UserError` for one that is damaged, or cut off.
    """
    cv2 = vision_library("cv2")
    coded = content(path)
    whole = coded and not _cut_off(coded)
    pixels = np.frombuffer(coded, dtype=np.uint8)
    image = cv2.imdecode(pixels, flag) if whole else None
    if image is None:
        raise UserError(f"{path}: not an image that can be read; it may be damaged")
    return np.asarray(image)


def alike(path: Path, flag: int, shape: tuple[int, ...], widest: int | None) -> NDArray[np.uint8]:
    """Return an image of the shape that all have, reduced to the widest.

    Raises `UserError` for another shape.
    """
    image = image_of(path, flag)
    if image.shape != shape:
        told = [f"{width} x {height}" for height, width in (image.shape, shape)]
        turned = "; turn it as the others are" if image.shape == shape[::-1] else ""
        raise UserError(f"{path}: {told[0]} pixels, the first image has {told[1]}{turned}")
    return reduced(image, widest)


def reduced(image: NDArray[np.uint8], widest: int | None) -> NDArray[np.uint8]:
    """Return an image with so many columns at most, each pixel the mean of those it covers."""
    height, width = image.shape[:2]
    if widest is None or width <= widest:
        return image
    cv2 = vision_library("cv2")
    size = widest, max(1, round(height * widest / width))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA))


def opacity_of(image: NDArray[Any]) -> NDArray[np.uint8]:
    """Return the opacity (row, column) of an image as it is stored, 255 where it tells none."""
    if image.shape[2:] != (4,):
        return np.full(image.shape[:2], 255, np.uint8)
    opacity = image[..., 3]
    return np.asarray(opacity // (np.iinfo(opacity.dtype).max // 255), dtype=np.uint8)


def as_held(paths: Sequence[Path]) -> int:
    """Return OpenCV's flag by which images are read as the camera was held, or as it sees them.

    The latter where EXIF says that it was held in several ways: on a stand it was not, whatever its
    sensor of gravity says when it looks down.
    """
    from PIL import Image

    held = set()
    for path in paths:
        if path.suffix.lower() in _TURNED:
            with suppress(OSError, ValueError, TypeError, SyntaxError), Image.open(path) as image:
                held.add(int(image.getexif().get(_ORIENTATION, 1)))
    ignored: int = vision_library("cv2").IMREAD_IGNORE_ORIENTATION
    return ignored if len(held) > 1 else 0


def _cut_off(content: bytes) -> bool:
    """Return whether a JPEG ends within its last scan, which decoders fill up with grey."""
    scan, end = (content.rfind(marker) for marker in (b"\xff\xda", b"\xff\xd9"))
    return content.startswith(b"\xff\xd8") and end < scan
