"""Masks of the body that somebody who knows has drawn, one for each image."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from debrisest.errors import UserError
from debrisest.vision.image_files import ImageSequence, read_images

_HALF = 127


def read_masks(
    path: Path, images: ImageSequence, widest: int | None = None, every: int = 1
) -> NDArray[np.uint8]:
    """Return masks (time, camera, row, column), 255 where the body is, one for each image.

    They are those of a folder, in the order of the numbers in their names, or those among other
    images whose names end in ``mask``; one of ``every`` so many, as of the images. Masks are
    inverted where most of their edges are white.

    Raises `UserError` as `read_images` does, and where they are not as many or as large as images.
    """
    found = read_images(path, widest, gaps=True, masks=True, every=every).frames
    if found.shape != images.frames.shape:
        told = [f"{len(one)} of {one.shape[3]} x {one.shape[2]}" for one in (found, images.frames)]
        raise UserError(f"{path}: masks: {told[0]} pixels, but images: {told[1]}; one for each")
    inside = found > _HALF
    edge = np.concatenate([inside[..., [0, -1], :].ravel(), inside[..., [0, -1]].ravel()])
    return np.where(inside != (edge.mean() > 0.5), np.uint8(255), np.uint8(0))
