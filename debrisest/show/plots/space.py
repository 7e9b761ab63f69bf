"""Axes of three dimensions at one scale."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from debrisest.arrays import Array
from debrisest.show.plots.style import GREY, SHADE

_NO_HEIGHT = 1e-3
_TICKS = 5
_TALL = 1.5
"""Height over width from which labels need room below and beside."""


def spatial_axes(figure: Figure, names: tuple[str, str, str]) -> tuple[Axes, Any]:
    """Return axes that only carry the heading, and below them spatial axes in metres."""
    grid = figure.add_gridspec(2, 1, height_ratios=(_NO_HEIGHT, 1.0))
    top = figure.add_subplot(grid[0])
    top.set_axis_off()
    axes: Any = figure.add_subplot(grid[1], projection="3d", computed_zorder=False)
    for axis, name in zip((axes.xaxis, axes.yaxis, axes.zaxis), names):
        axis.set_label_text(f"{name} [m]")
        axis.set_pane_color("white")
        axis.line.set_color(GREY)
        axis._axinfo["grid"].update(color=SHADE, linewidth=0.5)
    return top, axes


def same_scale(axes: Any, points: Array) -> None:
    """Show all of ``points (n, 3)`` with a metre as long along every axis."""
    finite = points[np.isfinite(points).all(-1)]
    if not len(finite):
        finite = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
    low, high = finite.min(0), finite.max(0)
    room = 0.05 * float((high - low).max()) or 1.0
    low, high = low - room, high + room
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.locator_params(nbins=_TICKS)
    tall = (high - low)[2] > _TALL * (high - low)[:2].max()
    axes.set_box_aspect(tuple(high - low), zoom=0.95 if tall else 1.1)
    axes.zaxis.labelpad = 10.0 if tall else 4.0
