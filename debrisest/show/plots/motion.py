"""Rate and attitude of the feature frame over time, and which measurements do not count."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from debrisest.arrays import Array, BoolArray, Data
from debrisest.show.plots.axes import heading, legend_below, quaternion_axis, shade, time_axis
from debrisest.show.plots.style import AXIS_COLOURS, GREY, INK, SHADE, WIDTH, styled
from debrisest.vocabulary import shown_unit, table_scale

DATASETS = ("rate_f", "rate_f_sigma", "q_if", "q_if_sigma")
_LONG_GAP = 5.0
"""An interval between epochs that is longer than so many medians is a gap."""
_REJECTED: dict[str, Any] = {"marker": "|", "color": INK, "linestyle": "none", "markersize": 6}


@styled
def motion(data: Data, context: str) -> Figure:
    """Draw ``rate_f (time, 3)`` and ``q_if (time, 4)`` with 3-sigma bands, gaps and rejections.

    Where torque-free motion is not accepted, the title says that they are from a smoother.
    """
    breaks = long_gaps(data["time_s"])
    times, rate, rate_sigma, q, q_sigma = _interrupted(data, breaks)
    figure = Figure(figsize=(WIDTH, 6.4))
    axes = list(figure.subplots(5, height_ratios=(3, 1, 1, 1, 1)))
    unit = shown_unit("rate_f")
    scale = table_scale("rate_f", unit)
    for index, colour in enumerate(AXIS_COLOURS):
        _banded(axes[0], times, scale * rate[:, index], scale * rate_sigma[:, index], colour)
    axes[0].set_ylabel(f"rate [{unit}]")
    for component, axis in enumerate(axes[1:]):
        _banded(axis, times, q[:, component], q_sigma[:, component], INK)
        quaternion_axis(axis, component)
    for axis in axes:
        shade(axis, breaks)
    _mark(axes[0], data["time_s"], np.asarray(data.get("rejected", np.nan) > 0))
    time_axis(axes, data["time_s"])
    smoothed = data.get("accepted", np.asarray(1.0)) < 1.0
    heading(axes[0], _NOT_ACCEPTED if smoothed else _TITLE, context)
    legend_below(figure, _handles())
    return figure


_TITLE = "Rate in axes fixed in the body, and attitude"
_NOT_ACCEPTED = f"{_TITLE} (torque-free motion NOT accepted)"


def long_gaps(times: Array) -> list[tuple[float, float]]:
    """Return start and length of every interval (time,) far longer than the median one."""
    steps = np.diff(times)
    if not len(steps):
        return []
    long = np.flatnonzero(steps > _LONG_GAP * np.median(steps))
    return [(float(times[k]), float(steps[k])) for k in long]


def _interrupted(data: Data, breaks: Sequence[tuple[float, float]]) -> list[Array]:
    """Return times and `DATASETS` with NaN in the middle of every gap, where no line is drawn."""
    starts = [start for start, _ in breaks]
    after = np.searchsorted(data["time_s"], starts) + 1
    middle = [start + length / 2 for start, length in breaks]
    values = [np.insert(data[name], after, np.nan, axis=0) for name in DATASETS]
    return [np.insert(data["time_s"], after, middle), *values]


def _banded(axis: Axes, times: Array, value: Array, sigma: Array, colour: str) -> None:
    axis.fill_between(
        times, value - 3 * sigma, value + 3 * sigma, color=colour, alpha=0.25, linewidth=0
    )
    axis.plot(times, value, color=colour, linewidth=1.2)


def _mark(axis: Axes, times: Array, rejected: BoolArray) -> None:
    """Mark epochs along the lower edge."""
    at = times[np.broadcast_to(rejected, times.shape)]
    axis.plot(at, np.full(len(at), 0.02), transform=axis.get_xaxis_transform(), **_REJECTED)


def _handles() -> list[Line2D | Patch]:
    lines = [
        Line2D([], [], color=colour, label=f"axis {index + 1}")
        for index, colour in enumerate(AXIS_COLOURS)
    ]
    band = Patch(facecolor=GREY, alpha=0.3, linewidth=0, label="±3σ")
    gap = Patch(facecolor=SHADE, linewidth=0, label="no epochs")
    return [*lines, band, gap, Line2D([], [], label="rejected", **_REJECTED)]
