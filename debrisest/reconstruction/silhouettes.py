"""Silhouettes of a turning body: before black sky by brightness, else by what is behind it."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import partial
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray
from debrisest.reconstruction import backdrop
from debrisest.reconstruction.backdrop import BORDER_PX, Smooth

_BLUR_PX = 1.0
_SIGMAS = 5.0
_LEAST_GREY = 1.5
_DARK_GREY = 12.0
"""Skies are darker than this in most of the border's pixels."""
_EDGE_PX = 3
_BRIGHT_GREY = 60.0
"""Contrasts beyond this, as of a pixel that is always the body's, count as this."""
_BLOCKS_PX = 17
"""As far as compression in blocks of 8 pixels reaches."""
_NO_COLOUR = 128
"""Cr and Cb of what is grey."""

Frames = NDArray[np.uint8]
_BRIGHT = "what is brighter than the dark behind it"


class Reading(NamedTuple):
    """Silhouettes, and how they were read from the images."""

    masks: BoolArray
    """(time, camera, row, column)."""
    said: str
    """What the body was taken to be, in words."""
    given: bool = False
    """Whether somebody who knows drew them."""


def silhouettes(frames: Frames, chroma: Frames | None = None) -> BoolArray:
    """Return where the body is in images (time, camera, row, column) of cameras that stand still.

    ``chroma (time, camera, row, column, 2)`` are Cr and Cb of images that have colours. Raises
    ValueError where nothing tells the body from what is behind it.
    """
    return readings(frames, chroma)[0].masks


def readings(frames: Frames, chroma: Frames | None = None) -> list[Reading]:
    """Return silhouettes as they can be read: before a plain backdrop, and by motion.

    Raises ValueError where there is none.
    """
    colours = [None] * frames.shape[1] if chroma is None else list(chroma.swapaxes(0, 1))
    each = [list(_of_camera(*one)) for one in zip(frames.swapaxes(0, 1), colours)]
    found = [
        Reading(np.stack([one.masks for one in cameras], axis=1), cameras[0].said)
        for cameras in zip(*each)
    ]
    told = [one for one in found if one.masks.any(axis=(0, 2, 3)).all()]
    if not told:
        raise ValueError("no body stands out from what is behind it, neither bright nor moving")
    return told


def before_backdrop(frames: Frames, chroma: Frames | None) -> BoolArray | None:
    """Return silhouettes of a body before a plain backdrop of some colour; None without one."""
    if chroma is None:
        return None
    with suppress(ValueError):
        first = readings(frames, chroma)[0]
        return first.masks if first.said == backdrop.STANDS_OUT else None
    return None


def _of_camera(frames: Frames, chroma: Frames | None) -> Iterator[Reading]:
    """Yield readings of the images (time, row, column) of one camera."""
    smooth = _blurred(frames)
    border = _border(smooth)
    if np.median(border) < _DARK_GREY:
        yield Reading(_masks(smooth - float(np.median(border)), _threshold(border)), _BRIGHT)
        return
    colours = [] if chroma is None else [chroma[..., 0], chroma[..., 1]]
    channels = [smooth, *(_blurred(each) - np.float32(_NO_COLOUR) for each in colours)]
    for behind in backdrop.readings(channels):
        masks = _masks(behind.contrasts(channels), behind.contrast, behind.beside)
        yield Reading(masks, behind.said)


def _masks(contrasts: Iterable[Array], level: float, beside: float = 0.0) -> BoolArray:
    """Return where contrasts are above a level, and above a share of those nearby, sharply."""
    return np.stack([_sharp(_largest(_above(each, level, beside)), each) for each in contrasts])


def _above(contrast: Array, level: float, beside: float) -> BoolArray:
    if not beside:
        return np.asarray(contrast > level)
    nearby = scipy.ndimage.maximum_filter(contrast, size=_BLOCKS_PX)
    return np.asarray(contrast > np.maximum(level, beside * np.minimum(nearby, _BRIGHT_GREY)))


def _blurred(frames: Frames) -> Smooth:
    blur = partial(scipy.ndimage.gaussian_filter, sigma=_BLUR_PX, output=np.float32)
    return np.stack([blur(frame) for frame in frames])


def _border(smooth: Smooth) -> Array:
    n = BORDER_PX
    edges = (smooth[:, :n], smooth[:, -n:], smooth[:, :, :n], smooth[:, :, -n:])
    return np.concatenate([edge.ravel() for edge in edges]).astype(np.float64)


def _threshold(values: Array) -> float:
    spread = 1.4826 * float(np.median(np.abs(values - np.median(values))))
    return max(_SIGMAS * spread, _LEAST_GREY)


def _sharp(mask: BoolArray, contrast: Array) -> BoolArray:
    """Return the mask cut back, along its edge, to where the contrast is half of that nearby."""
    edge = mask & ~scipy.ndimage.binary_erosion(mask, iterations=_EDGE_PX)
    nearby = scipy.ndimage.maximum_filter(contrast, size=2 * _EDGE_PX + 1)
    kept = mask & (~edge | (contrast > 0.5 * np.minimum(nearby, _BRIGHT_GREY)))
    return np.asarray(scipy.ndimage.binary_closing(kept, iterations=1) | kept)


def _largest(mask: BoolArray) -> BoolArray:
    """Return the largest connected piece, closed, without its small holes."""
    closed = scipy.ndimage.binary_closing(mask, iterations=2) | mask
    label, count = scipy.ndimage.label(scipy.ndimage.binary_opening(closed))
    if not count:
        return np.zeros_like(mask)
    sizes = np.bincount(label.ravel())[1:]
    piece = label == 1 + sizes.argmax()
    holes, number = scipy.ndimage.label(~piece)
    small = np.flatnonzero(np.bincount(holes.ravel()) < 0.002 * sizes.max())
    return np.asarray(piece | np.isin(holes, small[small > 0])) if number else piece
