"""Errors of all estimators of a case over time, with the bound."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading, log_axis, time_axis, unit
from debrisest.show.plots.style import WIDTH, estimator_looks, styled
from debrisest.vocabulary import table_scale

QUANTITIES = ("rate", "pitch", "attitude", "position", "velocity", "points")
_BAND = (10.0, 90.0)
"""Percentiles over the runs between which a band is drawn."""
_COLUMNS = 5


@styled
def estimators_over_time(data: Data, context: str) -> Figure:
    """Draw the RMS over runs of errors (run, time), which are named ``quantity/estimator``.

    The band of an estimator holds the absolute errors of four in five runs.
    """
    times = data["time_s"]
    found = [name.split("/") for name in data if "/" in name]
    quantities = [name for name in QUANTITIES if name in {one for one, _ in found}]
    estimators = list(dict.fromkeys(name for _, name in found))
    figure = Figure(figsize=(WIDTH, 1.6 + 2.2 * len(quantities)))
    axes = list(figure.subplots(len(quantities), sharex=True, squeeze=False)[:, 0])
    looks = estimator_looks(estimators)
    for axis, quantity in zip(axes, quantities):
        log_axis(axis)
        axis.set_ylabel(f"{quantity} [{unit(quantity)}]")
        for estimator in estimators:
            error = data.get(f"{quantity}/{estimator}")
            if error is not None:
                _lines(axis, times, error * table_scale(quantity), looks[estimator])
    time_axis(axes, times)
    heading(axes[0], "Errors of all estimators: RMS over runs, band of four in five", context)
    handles = [Line2D([], [], label=name, **look) for name, look in looks.items()]
    figure.legend(handles=handles, loc="outside lower center", ncols=min(_COLUMNS, len(handles)))
    return figure


def _lines(axis: Axes, times: Array, error: Array, look: dict[str, Any]) -> None:
    known = np.isfinite(error)
    count = known.sum(axis=0)
    total = np.sum(error**2, axis=0, where=known)
    mean_square = np.divide(total, count, out=np.full(len(times), np.nan), where=count > 0)
    rms = np.sqrt(np.where(mean_square > 0, mean_square, np.nan))
    axis.plot(times, rms, **look)
    shown = known.all(axis=0)
    if len(error) > 2 and "dashes" not in look and shown.any():
        low, high = np.percentile(np.abs(error[:, shown]), _BAND, axis=0)
        axis.fill_between(times[shown], low, high, color=look["color"], alpha=0.12, linewidth=0)
