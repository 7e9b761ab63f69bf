"""The attitude of single epochs, before anything is recovered (Biondi et al. 2017, Fig. 4)."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from debrisest.arrays import Data
from debrisest.show.plots.axes import heading, legend_below, quaternion_axis, shade_gaps, time_axis
from debrisest.show.plots.style import BLUE, SHADE, VERMILION, WIDTH, styled

_COLOURS = (BLUE, VERMILION)


@styled
def raw_quaternion(data: Data, context: str) -> Figure:
    """Draw ``raw_q_if`` (time, 4) with the pieces in turn in two colours and the gaps shaded."""
    times, raw, piece = data["time_s"], data["raw_q_if"], data["piece"]
    figure = Figure(figsize=(WIDTH, 5.6))
    axes = figure.subplots(4, sharex=True)
    for component, axis in enumerate(axes):
        shade_gaps(axis, times, ~np.isfinite(piece))
        for turn, colour in enumerate(_COLOURS):
            mine = np.where(piece % 2 == turn, raw[:, component], np.nan)
            axis.plot(times, mine, ".", color=colour, markersize=2.4, mew=0)
        quaternion_axis(axis, component)
    time_axis(axes, times)
    heading(axes[0], "Raw quaternion", context)
    legend_below(figure, _handles(int(np.isfinite(np.unique(piece)).sum())))
    return figure


def _handles(pieces: int) -> list[Line2D | Patch]:
    dots = [
        Line2D([], [], linestyle="", marker="o", markersize=4, color=colour, label=label)
        for colour, label in zip(_COLOURS, ("pieces 1, 3, ...", f"pieces 2, 4, ... (of {pieces})"))
    ]
    return [*dots, Patch(facecolor=SHADE, label="no attitude (too few features seen)")]
