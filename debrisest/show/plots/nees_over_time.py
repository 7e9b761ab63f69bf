"""Whether an estimator's errors are as large as it says, over time and all runs."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from debrisest.arrays import Array, BoolArray, Data
from debrisest.assessment.consistency import interval
from debrisest.show.plots.axes import heading, legend_below, log_axis, time_axis
from debrisest.show.plots.style import BLUE, GREY, INK, SKY, VERMILION, WIDTH, styled

_MEAN: dict[str, Any] = {"color": BLUE, "marker": "o", "markersize": 3.2, "linewidth": 1.4}
_MEDIAN: dict[str, Any] = {"color": VERMILION, "marker": "s", "markersize": 3.0, "linewidth": 1.0}
_MOST_MARKERS = 40
_FEW = 8
"""Epochs with a covariance up to which every run is drawn, and the interval as a bar."""
_RUN: dict[str, Any] = {"color": SKY, "marker": ".", "markersize": 4.5, "linestyle": "none"}
_RUN_HANDLE = Line2D([], [], label="single runs", **_RUN)


@styled
def nees_over_time(data: Data, context: str) -> Figure:
    """Draw mean and median over the runs of ``nees`` (run, time) per dimension.

    The band is where the mean of a consistent estimator lies with a probability of 95 %; it needs
    the dimensions ``nees_dof`` (run, time).
    """
    times, nees = data["time_s"], data["nees"]
    known = np.isfinite(nees)
    shown: BoolArray = np.asarray(known.any(axis=0))
    figure = Figure(figsize=(WIDTH, 3.6))
    axis = figure.subplots()
    log_axis(axis)
    mean, median = _over_runs(nees[:, shown], known[:, shown])
    low, high = _interval(data, known, shown)
    if few := int(shown.sum()) <= _FEW:
        _single_epochs(axis, times, shown, nees, low, high)
    else:
        axis.fill_between(times[shown], low, high, color=GREY, alpha=0.25, linewidth=0)
    axis.axhline(1, color=INK, linewidth=0.6)
    dense = int(shown.sum()) > _MOST_MARKERS
    for values, look in ((mean, _MEAN), (median, _MEDIAN)):
        axis.plot(times[shown], values, **{**look, **({"marker": ""} if dense else {})})
    every = nees[known & (nees > 0)] if few else mean
    axis.set_ylim(*_limits(np.concatenate([mean, median, low, high, every])))
    axis.set_ylabel("NEES per dimension")
    time_axis([axis], times)
    if few:
        axis.set_xlim(right=float(times[-1]) + _width(times))
    heading(axis, "Normalised estimation error squared", context)
    legend_below(figure, [*_handles("nees_dof" in data), *[_RUN_HANDLE] * few])
    return figure


def _single_epochs(
    axis: Axes, times: Array, shown: BoolArray, nees: Array, low: Array, high: Array
) -> None:
    """Draw every run at the few epochs whose covariance was kept, and the interval as a bar."""
    width = _width(times)
    axis.bar(times[shown], high - low, width, low, color=GREY, alpha=0.25, linewidth=0)
    for time, runs in zip(times[shown], nees[:, shown].T):
        aside = np.linspace(-0.35, 0.35, len(runs)) * width
        axis.plot(time + aside, np.where(runs > 0, runs, np.nan), **_RUN)


def _width(times: Array) -> float:
    """Return how wide the runs of an epoch are drawn beside each other, s."""
    return float(times[-1] - times[0]) / 25


def _over_runs(nees: Array, known: BoolArray) -> tuple[Array, Array]:
    """Mean and median (epoch,) of what is known; NaN where a log axis can show nothing."""
    mean = np.sum(nees, axis=0, where=known) / known.sum(axis=0)
    median = np.nanmedian(np.where(known, nees, np.nan), axis=0) if nees.size else mean
    return np.where(mean > 0, mean, np.nan), np.where(median > 0, median, np.nan)


def _interval(data: Data, known: BoolArray, shown: BoolArray) -> tuple[Array, Array]:
    """Return the interval (epoch,) of the mean over the runs; NaN if no dimension is known."""
    if "nees_dof" not in data:
        nothing = np.full(int(shown.sum()), np.nan)
        return nothing, nothing
    freedom = np.nansum(np.where(known, data["nees_dof"], 0.0), axis=0)[shown]
    return interval(np.where(freedom > 0, freedom, np.nan))


def _limits(values: Array) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    low, high = np.min(finite, initial=0.5), np.max(finite, initial=2.0)
    return (float(low / 1.2), float(1.2 * high))


def _handles(with_band: bool) -> list[Line2D | Patch]:
    lines = [Line2D([], [], label="mean", **_MEAN), Line2D([], [], label="median", **_MEDIAN)]
    band = Patch(facecolor=GREY, alpha=0.3, linewidth=0)
    band.set_label("95 % interval of the mean, if consistent")
    return [*lines, *([band] if with_band else [])]
