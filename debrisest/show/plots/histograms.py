"""Distribution over the runs of their mean errors (Pesce et al. 2017, Figs. 11-16)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading, legend_below, unit
from debrisest.show.plots.grid import COLUMNS, headed_grid
from debrisest.show.plots.style import BLUE, VERMILION, WIDTH, styled
from debrisest.vocabulary import table_scale

QUANTITIES = ("position", "velocity", "rate", "attitude", "k1", "k2")
SETTLED = 0.1
"""Part of the time that is left out at the start."""
_BINS = 24
_FARTHEST = 4.0
"""A bin axis ends at so many times the 90th percentile; runs beyond it are counted in words."""


@styled
def histograms(data: Data, context: str) -> Figure:
    """Draw, for every quantity (run, time) there is, a histogram of the runs' mean |error|."""
    shown = [name for name in QUANTITIES if name in data]
    rows = -(-len(shown) // COLUMNS)
    figure = Figure(figsize=(WIDTH, 1.4 + 1.9 * rows))
    top, grid = headed_grid(figure, rows)
    for axis, name in zip(grid.flat, shown):
        _quantity(axis, name, run_means(data["time_s"], data[name]) * table_scale(name))
    for axis in grid.flat[len(shown) :]:
        axis.set_visible(False)
    for axis in grid[:, 0]:
        axis.set_ylabel("runs")
    heading(top, "Mean errors of the runs", f"{context}; {_window(data['time_s'])}")
    legend_below(figure, _handles())
    return figure


def run_means(times: Array, error: Array) -> Array:
    """Mean of |error| (run, time) over the settled time, (run,); NaN if a run was ever lost."""
    settled = times >= times[0] + SETTLED * (times[-1] - times[0])
    return np.asarray(np.abs(error[:, settled]).mean(axis=-1))


def _window(times: Array) -> str:
    start = times[0] + SETTLED * (times[-1] - times[0])
    return f"means over {start:g}-{times[-1]:g} s"


def _quantity(axis: Axes, name: str, means: Array) -> None:
    known = means[np.isfinite(means)]
    axis.set_xlabel(f"{name} error" + (f" [{unit(name)}]" if unit(name) != "1" else ""))
    axis.yaxis.set_major_locator(MaxNLocator(5, integer=True))
    axis.xaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 2.5, 5, 10]))
    axis.xaxis.set_major_formatter("{x:g}")
    limit = _limit(known)
    axis.set_xlim(0, limit)
    if not len(known):
        axis.set_ylim(0, 1)
        return
    axis.hist(known, bins=_BINS, range=(0.0, limit), color=BLUE, alpha=0.8, linewidth=0)
    axis.axvline(float(np.median(known)), color=VERMILION, linewidth=1.4)
    beyond = int(np.sum(known > limit))
    if beyond:
        _note(axis, f"{beyond} beyond")


def _limit(known: Array) -> float:
    """Where the axis ends: at the largest mean, unless that is far from all others."""
    if not len(known) or not np.max(known) > 0:
        return 1.0
    near = _FARTHEST * float(np.percentile(known, 90))
    largest = float(np.max(known))
    return min(near, 1.02 * largest) if near > 0 else 1.02 * largest


def _note(axis: Axes, text: str) -> None:
    axis.text(0.98, 0.95, text, transform=axis.transAxes, ha="right", va="top", fontsize=8)


def _handles() -> list[Line2D | Patch]:
    return [
        Patch(facecolor=BLUE, alpha=0.8, linewidth=0, label="runs"),
        Line2D([], [], color=VERMILION, linewidth=1.4, label="median"),
    ]
