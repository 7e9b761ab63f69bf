"""Images without shading, which does not turn with a body as its pattern does."""

import numpy as np
import scipy

from debrisest.vision.optical_flow import Image

_REACH = 6.0
"""Sigma, px, of what counts as surroundings."""
_LEAST = 3.0
"""Grey levels of contrast below which there is noise only."""
_MIDDLE, _GAIN = 128.0, 45.0


def evened(image: Image) -> Image:
    """Return an image whose brightness and contrast are the same everywhere."""
    grey = image.astype(float)
    mean = scipy.ndimage.gaussian_filter(grey, _REACH)
    spread = np.sqrt(np.maximum(scipy.ndimage.gaussian_filter(grey**2, _REACH) - mean**2, 0.0))
    even = (grey - mean) / (spread + _LEAST)
    return np.asarray(np.clip(_MIDDLE + _GAIN * even, 0, 255), dtype=np.uint8)
