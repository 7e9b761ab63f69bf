"""What was followed in images: tracks over an image, and a strip of the sequence."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from debrisest.arrays import Array
from debrisest.show.plots.style import SKY, VERMILION, WIDTH, styled

_TAIL = 10
"""Epochs of a track that are drawn."""
_IN_STRIP = 6
_AROUND = 0.05
"""Part of the image that is shown around all features."""


@styled
def tracks_over_image(images: NDArray[np.uint8], pixels: Array, epoch: int) -> Figure:
    """Draw the last epochs of all tracks ``pixels (epoch, feature, 2)`` over one of the images."""
    (left, top), (right, bottom) = _about(pixels, images.shape[1:])
    figure = Figure(figsize=(WIDTH, WIDTH * (bottom - top) / (right - left) + 0.3))
    axis = figure.subplots()
    tail = pixels[max(epoch - _TAIL, 0) : epoch + 1]
    now = np.isfinite(tail[-1, :, 0])
    _shown(axis, images[epoch])
    axis.plot(tail[:, now, 0], tail[:, now, 1], color=SKY, linewidth=0.7, rasterized=True)
    axis.plot(*tail[-1, now].T, ".", color=VERMILION, markersize=2.5)
    axis.set(xlim=(left, right), ylim=(bottom, top))
    axis.set_title(
        f"image {epoch}: {int(now.sum())} features, and where they were in the "
        f"{len(tail) - 1} images before"
    )
    return figure


@styled
def strip(images: NDArray[np.uint8], pixels: Array, times: Array) -> Figure:
    """Draw images spread over the sequence, with the features ``(epoch, feature, 2)`` in them."""
    chosen = np.unique(np.linspace(0, len(images) - 1, _IN_STRIP).astype(int))
    height, width = images.shape[1:]
    each = WIDTH / 3
    rows = -(-len(chosen) // 3)
    figure = Figure(figsize=(WIDTH, rows * (each * height / width + 0.25)))
    axes = figure.subplots(rows, 3, squeeze=False).ravel()
    for axis, epoch in zip(axes, chosen):
        _shown(axis, images[epoch])
        axis.plot(*pixels[epoch].T, ".", color=VERMILION, markersize=1.2)
        axis.set_title(f"{times[epoch]:g} s")
    for axis in axes[len(chosen) :]:
        axis.set_visible(False)
    return figure


def _about(pixels: Array, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Return the corners (2,) of the part of an image that has features at any time."""
    size = np.array(shape[::-1], dtype=float)
    first, last = (pick(pixels.reshape(-1, 2), axis=0) for pick in (np.nanmin, np.nanmax))
    return np.maximum(first - _AROUND * size, -0.5), np.minimum(last + _AROUND * size, size - 0.5)


def _shown(axis: Axes, image: NDArray[np.uint8]) -> None:
    """Draw an image, brighter where it is dark, without axes."""
    brightest = max(float(np.quantile(image, 0.999)), 1.0)
    axis.imshow(image, cmap="gray", vmin=0, vmax=brightest, interpolation="antialiased")
    axis.set(xlim=(-0.5, image.shape[1] - 0.5), ylim=(image.shape[0] - 0.5, -0.5))
    axis.set_axis_off()
