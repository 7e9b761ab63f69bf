"""What moves in images of a camera that stands still."""

import numpy as np
import scipy

from debrisest.arrays import BoolArray
from debrisest.vision.optical_flow import Image

_SIGMAS = 4.0
_AROUND = 5
"""Pixels over which a change is averaged, and by which its area grows."""


def moving(frames: Image, epoch: int, body: BoolArray | None = None) -> BoolArray:
    """Return where an image (row, column) of ``frames (time, row, column)`` changes.

    Between the frames before and after, by more than the noise that most of the image has; within
    ``body (time, row, column)``, if it is told from what is behind it, whose shadows move too.
    """
    near = frames[max(epoch - 1, 0) : epoch + 2].astype(float)
    change = scipy.ndimage.uniform_filter(np.ptp(near, axis=0), _AROUND)
    middle = np.median(change)
    spread = 1.4826 * np.median(np.abs(change - middle)) + 0.1
    changes = change > middle + _SIGMAS * spread
    grown = scipy.ndimage.binary_dilation(changes, iterations=_AROUND)
    return np.asarray(grown if body is None else grown & body[epoch])
