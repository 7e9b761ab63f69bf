"""Distribution over the runs of their mean errors (Pesce et al. 2017, Figs. 11-16)."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading, legend_below, unit
from debrisest.show.plots.gather import ALONE, Beside
from debrisest.show.plots.grid import COLUMNS, headed_grid
from debrisest.show.plots.style import BLUE, GREEN, INK, VERMILION, WIDTH, styled
from debrisest.vocabulary import table_scale

QUANTITIES = ("position", "velocity", "rate", "attitude", "k1", "k2")
SETTLED = 0.1
"""Part of the time that is left out at the start."""
_BINS = 24
_BOUND: dict[str, Any] = {"color": GREEN, "linewidth": 1.4, "dashes": (3, 2)}
_PUBLISHED: dict[str, Any] = {"color": INK, "linewidth": 1.4}
_NONE = np.zeros((0, 1))
_FARTHEST = 4.0
"""A bin axis ends at so many times the 90th percentile; runs beyond it are counted in words."""


@styled
def histograms(data: Data, context: str, beside: Beside = ALONE) -> Figure:
    """Draw, for every quantity (run, time) there is, a histogram of the runs' mean |error|."""
    times = data["time_s"]
    shown = [name for name in QUANTITIES if name in data]
    rows = -(-len(shown) // COLUMNS)
    figure = Figure(figsize=(WIDTH, 1.4 + 1.9 * rows))
    top, grid = headed_grid(figure, rows)
    for axis, name in zip(grid.flat, shown):
        told = beside.units.get(name) or unit(name)
        means = run_means(times, data[name]) * table_scale(name, told)
        bound = run_means(times, beside.bound.get(name, _NONE)) * table_scale(name, told)
        _quantity(axis, name, told, means, _known(bound), beside.published.get(name))
    for axis in grid.flat[len(shown) :]:
        axis.set_visible(False)
    for axis in grid[:, 0]:
        axis.set_ylabel("runs")
    heading(top, "Mean errors of the runs", f"{context}; means over {window(times)}")
    legend_below(figure, _handles(bool(beside.bound), bool(beside.published)))
    return figure


def run_means(times: Array, error: Array) -> Array:
    """Mean of |error| (run, time) over the settled time, (run,); NaN if a run was ever lost."""
    if not len(error):
        return np.zeros(0)
    settled = times >= times[0] + SETTLED * (times[-1] - times[0])
    return np.asarray(np.abs(error[:, settled]).mean(axis=-1))


def window(times: Array) -> str:
    """Return the settled time as the tables write windows."""
    start = times[0] + SETTLED * (times[-1] - times[0])
    return f"{start:g}-{times[-1]:g} s"


def _known(means: Array) -> Array:
    return means[np.isfinite(means)]


def _quantity(
    axis: Axes, name: str, told: str, means: Array, bound: Array, published: float | None
) -> None:
    known = _known(means)
    axis.set_xlabel(f"{name} error" + (f" [{told}]" if told != "1" else ""))
    axis.yaxis.set_major_locator(MaxNLocator(5, integer=True))
    axis.xaxis.set_major_locator(MaxNLocator(3, steps=[1, 2, 2.5, 5, 10]))
    axis.xaxis.set_major_formatter("{x:g}")
    limit = _limit(known)
    axis.set_xlim(0, limit)
    if len(bound):
        axis.axvline(float(np.median(bound)), **_BOUND)
    if published is not None and published <= limit:
        axis.axvline(published, **_PUBLISHED)
    elif published is not None:
        _note(axis, f"published: {published:.3g}", 0.82)
    if not len(known):
        axis.set_ylim(0, 1)
        return
    counts, edges = np.histogram(known, bins=_BINS, range=(0.0, limit))
    axis.stairs(counts, edges, fill=True, color=BLUE, alpha=0.8, linewidth=0)
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


def _note(axis: Axes, text: str, height: float = 0.95) -> None:
    axis.text(0.98, height, text, transform=axis.transAxes, ha="right", va="top", fontsize=8)


def _handles(with_bound: bool, with_published: bool) -> list[Line2D | Patch]:
    lines = [
        Line2D([], [], color=VERMILION, linewidth=1.4, label="median"),
        *[Line2D([], [], label="median of the bound", **_BOUND)] * with_bound,
        *[Line2D([], [], label="published", **_PUBLISHED)] * with_published,
    ]
    return [Patch(facecolor=BLUE, alpha=0.8, linewidth=0, label="runs"), *lines]
