"""Silhouettes of a turning body: before black sky by brightness, before a room by motion.

On a turntable some pixels show the body in most images, so that motion takes it for background:
where the edges of the images show a plain backdrop, its levels count there.
"""

from functools import partial

import numpy as np
import scipy
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray

_BLUR_PX = 1.0
_SIGMAS = 5.0
_LEAST_GREY = 1.5
_DARK_GREY = 12.0
"""Skies are darker than this in most of the border's pixels."""
_BACKGROUND_SHARE = 0.25
"""Of the frames in which a pixel has to show the same, for that to be the background."""
_EDGE_SHARE, _PLAIN_SHARE, _PLAIN_GREY = 0.1, 0.95, 5.0
"""A backdrop is plain whose levels are smooth to this many in this share of the images' edges."""
_BORDER_PX = 4
_EDGE_PX = 3
_BRIGHT_GREY = 60.0
"""Contrasts beyond this, as of a pixel that is always the body's, count as this."""

Frames = NDArray[np.uint8]


def silhouettes(frames: Frames) -> BoolArray:
    """Return where the body is in images (time, camera, row, column) of cameras that stand still.

    Raises ValueError where nothing tells the body from what is behind it.
    """
    shown = [_of_camera(frames[:, camera]) for camera in range(frames.shape[1])]
    return np.stack(shown, axis=1)


def _of_camera(frames: Frames) -> BoolArray:
    blur = partial(scipy.ndimage.gaussian_filter, sigma=_BLUR_PX, output=np.float32)
    smooth = np.stack([blur(frame) for frame in frames])
    border = _border(smooth)
    if np.median(border) < _DARK_GREY:
        contrast, level = smooth - float(np.median(border)), _threshold(border)
    else:
        background, sigma = _background(smooth)
        background = _corrected(background, _backdrop(smooth))
        contrast, level = np.abs(smooth - background), max(_SIGMAS * sigma, _LEAST_GREY)
    masks = np.stack([_sharp(_largest(each > level), each) for each in contrast])
    if not masks.any():
        raise ValueError("no body stands out from what is behind it, neither bright nor moving")
    return masks


def _border(smooth: NDArray[np.float32]) -> Array:
    n = _BORDER_PX
    edges = (smooth[:, :n], smooth[:, -n:], smooth[:, :, :n], smooth[:, :, -n:])
    return np.concatenate([edge.ravel() for edge in edges]).astype(np.float64)


def _threshold(values: Array) -> float:
    spread = 1.4826 * float(np.median(np.abs(values - np.median(values))))
    return max(_SIGMAS * spread, _LEAST_GREY)


def _background(smooth: NDArray[np.float32]) -> tuple[Array, float]:
    """Return what each pixel shows most steadily (row, column), NaN-free, and its noise.

    Where even the steadiest values are spread, the body is there in every frame.
    """
    count = max(3, round(_BACKGROUND_SHARE * len(smooth)))
    ordered = np.sort(smooth, axis=0)
    width = ordered[count - 1 :] - ordered[: len(ordered) - count + 1]
    best = width.argmin(axis=0)
    level = np.take_along_axis(ordered, best[None] + count // 2, axis=0)[0]
    narrow = width.min(axis=0)
    usual = float(np.median(narrow[_BORDER_PX:-_BORDER_PX, _BORDER_PX:-_BORDER_PX]))
    sigma = float(np.median(np.abs(smooth - level)[:, :_BORDER_PX])) * 1.4826
    always_body = narrow > 4.0 * max(usual, sigma)
    return np.where(always_body, -1e3, level).astype(np.float64), sigma


def _backdrop(smooth: NDArray[np.float32]) -> Array | None:
    """Return the levels (row, column) of a plain backdrop, None where what is behind has details.

    A quadratic of row and column through what the edges of the images show.
    """
    usual = np.median(smooth, axis=0).astype(np.float64)
    rows, columns = usual.shape
    v, u = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    terms = np.stack([np.ones_like(u), u, v, u * u, u * v, v * v], axis=-1)
    edge = np.maximum(np.abs(u), np.abs(v)) > 1.0 - _EDGE_SHARE
    fitted = np.linalg.lstsq(terms[edge], usual[edge], rcond=None)[0]
    off = np.abs(terms[edge] @ fitted - usual[edge])
    return terms @ fitted if np.quantile(off, _PLAIN_SHARE) < _PLAIN_GREY else None


def _corrected(background: Array, backdrop: Array | None) -> Array:
    """Return the background, with the backdrop's levels where it shows the body all the time."""
    if backdrop is None:
        return background
    own = np.abs(background - backdrop) < 2.0 * _PLAIN_GREY
    return np.where(own, background, backdrop)


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
