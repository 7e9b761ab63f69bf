"""Control torques of every control section (Li et al. 2011, Figs. 6 and 7)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading, legend_below
from debrisest.show.plots.grid import panel_grid
from debrisest.show.plots.sections import control_sections
from debrisest.show.plots.style import AXIS_COLOURS, SHADE, WIDTH, styled
from debrisest.vocabulary import table_scale

_SPIKE = 4.0
"""A torque that is so many times the usual one is a spike."""


@styled
def torques(data: Data, context: str) -> Figure:
    """Draw the torque (control time, observer, 3): a row for each section, a column a satellite."""
    names, times = data["observer"], data["control_time_s"]
    torque = data["torque"] * table_scale("torque", "mN m")
    spans = control_sections(data["time_s"], data["section"])
    rows = max(1, len(spans))
    figure = Figure(figsize=(WIDTH, 1.4 + 2.0 * rows))
    top, grid = panel_grid(figure, rows, len(names), sharey=True)
    for row, span in zip(grid, spans):
        inside = (times >= span[0]) & (times < span[1])
        for column, axis in enumerate(row):
            _section(axis, times[inside], torque[inside, column], span)
    _scale(list(grid.flat), torque)
    for row, axis in enumerate(grid[:, 0]):
        axis.set_ylabel(f"C{row + 1}: torque [mN m]")
    for axis, name in zip(grid[0], names):
        axis.text(0.97, 0.93, str(name), transform=axis.transAxes, ha="right", va="top")
    for axis in grid[-1]:
        axis.set_xlabel("time [s]")
    heading(top, "Control torques, body axes (shaded: linear scale)", context)
    legend_below(figure, _handles())
    return figure


def _section(axis: Axes, times: Array, torque: Array, span: tuple[float, float]) -> None:
    for index, colour in enumerate(AXIS_COLOURS):
        axis.plot(times, torque[:, index], color=colour, linewidth=1.0)
    axis.set_xlim(*span)


def _scale(panels: list[Axes], torque: Array) -> None:
    """Let panels that share their axis show a spike and what is far smaller than it.

    Linear up to what is not exceeded in nine of ten epochs, logarithmic above, if a spike is there.
    """
    size = np.abs(torque[np.isfinite(torque)])
    size = size[size > 0]
    usual, largest = (np.percentile(size, 90), np.max(size)) if len(size) else (1.0, 1.0)
    if largest > _SPIKE * usual:
        panels[0].set_yscale("symlog", linthresh=float(usual), linscale=1.5)
        panels[0].yaxis.set_major_formatter("{x:g}")
        for axis in panels:
            axis.axhspan(-usual, usual, color=SHADE, alpha=0.5, linewidth=0, zorder=0)
    panels[0].set_ylim(-1.3 * largest, 1.3 * largest)


def _handles() -> list[Line2D]:
    return [
        Line2D([], [], color=colour, linewidth=1.0, label=name)
        for colour, name in zip(AXIS_COLOURS, "xyz")
    ]
