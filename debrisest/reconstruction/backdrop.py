"""What is behind a body that turns before a still camera, and how far images are from it.

It is what each pixel shows most steadily. On a turntable some pixels show the body in most images,
so that motion takes it for background: where the edges of the images show a plain backdrop, its
levels count there. Levels are a list of channels: grey, and for images with colours Cr and Cb.
Darker shades of a coloured backdrop are its own, as shadows are (Horprasert et al. 1999).
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray

_SIGMAS = 5.0
_LEAST_GREY = 1.5
_BACKGROUND_SHARE = 0.25
"""Of the frames in which a pixel has to show the same, for that to be the background."""
_EDGE_SHARE, _PLAIN_SHARE, _PLAIN_GREY = 0.1, 0.7, 5.0
"""A backdrop is plain whose levels are smooth to this many in this share of the images' edges."""
_FITS = 5
_COLOURED, _SHADES = 12.0, (0.5, 1.15)
"""Least chroma of a coloured backdrop; its shades, of the usual one."""
_BESIDE, _LOSSY_GREY = 0.2, 3.0
"""Of photographs, in which compression leaves waves beside strong edges."""
BORDER_PX = 4
STANDS_OUT = "what differs from a plain backdrop, which the edges of the images show"
_MOVES = "what differs from what each pixel shows most steadily"

Smooth = NDArray[np.float32]


class Behind(NamedTuple):
    """What is behind the body, and from which contrast on a pixel is the body's."""

    levels: Array
    """(channel, row, column)."""
    contrast: float
    said: str
    """What the body is then, in words."""
    beside: float = 0.0
    """Share of the contrast nearby that a pixel of the body has at least."""

    def contrasts(self, channels: Sequence[Smooth]) -> Iterator[Array]:
        """Yield how far each image (row, column) of channels (time, row, column) is from it."""
        for shown in zip(*channels):
            yield apart(np.stack(shown), self.levels)


def readings(channels: Sequence[Smooth]) -> Iterator[Behind]:
    """Yield what is behind with a plain backdrop, if there is one, and by motion alone.

    By motion alone what is plain and stands still, or turns without a change as a plain turntable
    does, is none of the body; nor are plain parts of the body.
    """
    found = [_background(each) for each in channels]
    steady, spread = (np.stack(each) for each in zip(*(each[:2] for each in found)))
    sigma = np.linalg.norm([each.sigma for each in found])
    level, backdrop = max(_SIGMAS * float(sigma), _LEAST_GREY), _backdrop(channels)
    always_body = spread > np.array([each.most for each in found])[:, None, None]
    if backdrop is None:
        yield Behind(np.where(always_body, -1e3, steady), level, _MOVES)
        return
    own = apart(steady, backdrop) < 2.0 * _PLAIN_GREY
    yield Behind(np.where(own, steady, backdrop), level, STANDS_OUT, _BESIDE)
    always_body &= (spread > _LOSSY_GREY) & ~own
    yield Behind(np.where(always_body, -1e3, steady), level, _MOVES, _BESIDE)


def apart(shown: Array | Smooth, behind: Array) -> Array:
    """Return the distance (...) of levels (channel, ...) from those behind, in whatever shade."""
    if len(shown) == 1:
        return np.asarray(np.abs(shown[0] - behind[0]))
    colour = np.median(np.linalg.norm(behind[1:], axis=0))
    shades = _SHADES if colour > _COLOURED else (1.0, 1.0)
    shade = (shown * behind).sum(axis=0) / np.maximum((behind**2).sum(axis=0), 1.0)
    return np.asarray(np.linalg.norm(shown - np.clip(shade, *shades) * behind, axis=0))


class _Steady(NamedTuple):
    """What each pixel shows most steadily (row, column), and how far this is spread."""

    level: Array
    spread: Array
    most: float
    """Spread beyond which the body is there in every frame."""
    sigma: float
    """Noise of a pixel."""


def _background(smooth: Smooth) -> _Steady:
    count = max(3, round(_BACKGROUND_SHARE * len(smooth)))
    ordered = np.sort(smooth, axis=0)
    width = ordered[count - 1 :] - ordered[: len(ordered) - count + 1]
    best = width.argmin(axis=0)
    level = np.take_along_axis(ordered, best[None] + count // 2, axis=0)[0]
    narrow, n = width.min(axis=0), BORDER_PX
    usual = float(np.median(narrow[n:-n, n:-n]))
    sigma = float(np.median(np.abs(smooth - level)[:, :n])) * 1.4826
    return _Steady(level.astype(np.float64), narrow, 4.0 * max(usual, sigma), sigma)


def _backdrop(channels: Sequence[Smooth]) -> Array | None:
    """Return the levels (channel, row, column) of a plain backdrop; None where it has details.

    A quadratic of row and column through most of what the edges of the images show, then a cubic
    through all that is like it.
    """
    usual = np.stack([np.median(each, axis=0).astype(np.float64) for each in channels])
    rows, columns = usual.shape[1:]
    v, u = np.meshgrid(np.linspace(-1, 1, rows), np.linspace(-1, 1, columns), indexing="ij")
    edge: BoolArray = np.maximum(np.abs(u), np.abs(v)) > 1.0 - _EDGE_SHARE
    terms = np.stack([u**i * v**j for i in range(4) for j in range(4 - i)])
    quadratic = np.stack([u**i * v**j for i in range(3) for j in range(3 - i)])
    fitted = _fitted(quadratic, usual, edge)
    for _ in range(_FITS):
        off = apart(usual, fitted)
        near = edge & (off <= max(_PLAIN_GREY, float(np.median(off[edge]))))
        fitted = _fitted(quadratic, usual, near)
    off = apart(usual, fitted)
    if np.quantile(off[edge], _PLAIN_SHARE) >= _PLAIN_GREY:
        return None
    return _fitted(terms, usual, off < _PLAIN_GREY)


def _fitted(terms: Array, levels: Array, used: BoolArray) -> Array:
    """Return the sums of terms (term, row, column) that are nearest to levels where they count."""
    found = np.linalg.lstsq(terms[:, used].T, levels[:, used].T, rcond=None)[0]
    return np.asarray(np.einsum("tc,tij->cij", found, terms))
