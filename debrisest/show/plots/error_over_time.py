"""Mean and largest rate error of all runs over time (Biondi et al. 2017, Fig. 11)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading, legend_below, time_axis, unit
from debrisest.show.plots.style import AXIS_COLOURS, GREY, WIDTH, styled
from debrisest.vocabulary import table_scale

QUANTITIES = ("rate_1", "rate_2", "rate_3")


@styled
def error_over_time(data: Data, context: str) -> Figure:
    """Draw mean and maximum over the runs of the absolute errors (run, time), one axis each."""
    times = data["time_s"]
    figure = Figure(figsize=(WIDTH, 5.6))
    axes = list(figure.subplots(3, sharex=True, sharey=True))
    shown = [_over_runs(np.abs(data[name]) * table_scale(name)) for name in QUANTITIES]
    for axis, name, (mean, largest), colour in zip(axes, QUANTITIES, shown, AXIS_COLOURS):
        _component(axis, times, mean, largest, colour)
        axis.set_ylabel(f"|error {name[-1]}| [{unit(name)}]")
    _limit(axes[0], np.array(shown))
    time_axis(axes, times)
    heading(axes[0], "Rate error about the principal axes", context)
    legend_below(figure, _handles())
    return figure


def _over_runs(error: Array) -> tuple[Array, Array]:
    """Return mean and maximum (time,) of absolute errors (run, time), NaN where there is none."""
    known = np.isfinite(error)
    mean = _positive(np.sum(error, axis=0, where=known), np.sum(known, axis=0))
    return mean, _positive(np.max(error, axis=0, where=known, initial=0.0))


def _positive(total: Array, count: Array | int = 1) -> Array:
    """Return ``total / count`` where that is positive, else NaN: all that a log axis can show."""
    shown = total > 0
    return np.divide(total, count, out=np.full_like(total, np.nan), where=shown)


def _component(axis: Axes, times: Array, mean: Array, largest: Array, colour: str) -> None:
    axis.set_yscale("log")
    axis.yaxis.set_major_formatter("{x:g}")
    axis.fill_between(times, mean, largest, color=colour, alpha=0.15, linewidth=0)
    axis.plot(times, largest, color=colour, linewidth=0.8, alpha=0.75)
    axis.plot(times, mean, color=colour, linewidth=1.6)


def _limit(axis: Axes, shown: Array) -> None:
    """Show all but the deepest dips, where an error only changes its sign."""
    finite = shown[np.isfinite(shown)]
    if len(finite):
        axis.set_ylim(np.percentile(finite, 0.5) / 1.5, 1.5 * np.max(finite))


def _handles() -> list[Line2D]:
    return [
        Line2D([], [], color=GREY, linewidth=1.6, label="mean over the runs"),
        Line2D([], [], color=GREY, linewidth=0.8, label="largest of all runs"),
    ]
