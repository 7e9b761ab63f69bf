"""Where the debris is in the images (Li et al. 2011, Fig. 5)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading, legend_below
from debrisest.show.plots.grid import panel_grid
from debrisest.show.plots.style import BLUE, INK, VERMILION, WIDTH, styled

_COLUMNS = 2
_MARGIN = 1.08
"""How far the axes reach beyond the image."""


@styled
def pixel_paths(data: Data, context: str) -> Figure:
    """Draw the debris' pixel (time, observer, 2) in each camera, and the border of the image."""
    names, pixel = data["observer"], data["true_pixel"]
    rows = -(-len(names) // _COLUMNS)
    figure = Figure(figsize=(WIDTH, 1.25 + 2.45 * rows))
    top, grid = panel_grid(figure, rows, _COLUMNS)
    for axis, name, path in zip(grid.flat, names, np.moveaxis(pixel, 1, 0)):
        _image(axis, str(name), data["image_half_size"])
        _path(axis, path, data["section"])
    for axis in grid.flat[len(names) :]:
        axis.set_visible(False)
    heading(top, "Path of the debris in the images", context)
    legend_below(figure, _handles())
    return figure


def _image(axis: Axes, name: str, half_size: Array) -> None:
    width, height = (float(half) for half in half_size)
    border = Rectangle((-width, -height), 2 * width, 2 * height, fill=False)
    border.set(edgecolor=INK, linewidth=1.0)
    axis.add_patch(border)
    axis.set_aspect("equal")
    axis.set_xlim(-_MARGIN * width, _MARGIN * width)
    axis.set_ylim(-_MARGIN * height, _MARGIN * height)
    axis.set_xlabel("$p_x$ [px]")
    axis.set_ylabel("$p_y$ [px]")
    axis.text(0.07, 0.92, name, transform=axis.transAxes, va="top")


def _path(axis: Axes, path: Array, section: Array) -> None:
    """Draw a path (time, 2) section by section, each with its name where it begins."""
    numbers = np.unique(section[np.isfinite(section)])
    for number in numbers:
        mine = np.flatnonzero(section == number)
        turns = number % 2 == 1
        through = path[mine[0] : mine[-1] + 2]
        shade = 0.35 + 0.65 * (number - numbers[0] + 1) / (np.ptp(numbers) + 1)
        colour, width = (VERMILION, 0.9) if turns else (BLUE, 1.8)
        axis.plot(*through.T, color=colour, linewidth=width, alpha=shade, zorder=3)
        seen = through[np.isfinite(through).all(axis=-1)]
        if len(seen):
            _name(axis, seen[len(seen) // 2], f"{'C' if turns else 'E'}{int(number) // 2 + 1}")
    known = path[np.isfinite(path).all(axis=-1)]
    for place, marker in zip(known[:1], "o"):
        axis.plot(*place, marker=marker, markersize=4, color=INK, linestyle="none", zorder=4)
    for place, marker in zip(known[-1:], "s"):
        axis.plot(*place, marker=marker, markersize=4, color=INK, linestyle="none", zorder=4)


def _name(axis: Axes, place: Array, text: str) -> None:
    """Write the name of a section beside its middle, where it is within the image."""
    axis.annotate(
        text,
        xy=(float(place[0]), float(place[1])),
        xytext=(4, 4),
        textcoords="offset points",
        fontsize=7,
        color=VERMILION if text.startswith("C") else BLUE,
        annotation_clip=True,
        zorder=5,
    )


def _handles() -> list[Line2D | Patch]:
    return [
        Line2D([], [], color=BLUE, linewidth=1.6, label="estimation (E1, E2, ...)"),
        Line2D([], [], color=VERMILION, linewidth=0.9, label="cameras turn (C1, ...)"),
        Line2D([], [], color=INK, marker="o", markersize=4, linestyle="none", label="start"),
        Line2D([], [], color=INK, marker="s", markersize=4, linestyle="none", label="end"),
        Patch(facecolor="none", edgecolor=INK, linewidth=1.0, label="border of the image"),
    ]
