"""Estimated rates in principal axes with their 3-sigma band (Biondi et al. 2017, Fig. 10)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from debrisest.arrays import Array, Data
from debrisest.dynamics.inertia import principal_axes
from debrisest.show.plots.axes import heading, legend_below, time_axis, unit
from debrisest.show.plots.style import AXIS_COLOURS, GREY, TRUTH, WIDTH, styled
from debrisest.vocabulary import table_scale

_AXES = range(3)


@styled
def rates(data: Data, context: str) -> Figure:
    """Draw ``rate_b`` (time, 3) relabeled to true principal axes, and its error if it is known."""
    times, truth = data["time_s"], _truth(data)
    estimate, sigma = _relabeled(data)
    ratios = (2.3, 1, 1, 1) if truth is not None else (1,)
    figure = Figure(figsize=(WIDTH, 7.2 if truth is not None else 3.4))
    axes = list(figure.subplots(len(ratios), squeeze=False, height_ratios=ratios)[:, 0])
    _rates(axes[0], times, estimate, sigma, truth)
    if truth is not None:
        for index, axis in enumerate(axes[1:]):
            _error(axis, index, times, (estimate - truth)[:, index], 3 * sigma[:, index])
    time_axis(axes, times)
    heading(axes[0], "Angular rate in principal axes", context)
    legend_below(figure, _handles(truth is not None))
    return figure


def _relabeled(data: Data) -> tuple[Array, Array]:
    """Return rate and sigma (time, 3) in true principal axes, in the unit of the tables."""
    relabeling = data.get("relabeling", np.eye(3))
    scale = table_scale("rate")
    rate = scale * data["rate_b"] @ relabeling.T
    return rate, scale * data["rate_b_sigma"] @ np.abs(relabeling.T)


def _truth(data: Data) -> Array | None:
    if "true_rate_b" not in data or "true_inertia_b" not in data:
        return None
    _, axes = principal_axes(data["true_inertia_b"])
    return np.asarray(table_scale("rate") * data["true_rate_b"] @ axes)


def _rates(axis: Axes, times: Array, estimate: Array, sigma: Array, truth: Array | None) -> None:
    for index, colour in zip(_AXES, AXIS_COLOURS):
        low, high = (
            estimate[:, index] - 3 * sigma[:, index],
            estimate[:, index] + 3 * sigma[:, index],
        )
        axis.fill_between(times, low, high, color=colour, alpha=0.2, linewidth=0)
        axis.plot(times, estimate[:, index], color=colour, linewidth=1.6)
        if truth is not None:
            axis.plot(times, truth[:, index], **TRUTH)
    axis.set_ylim(*_range(estimate if truth is None else truth))
    axis.set_ylabel(f"rate [{unit('rate')}]")


def _error(axis: Axes, index: int, times: Array, error: Array, bound: Array) -> None:
    colour = AXIS_COLOURS[index]
    axis.fill_between(times, -bound, bound, color=colour, alpha=0.2, linewidth=0)
    axis.plot(times, error, color=colour, linewidth=0.8)
    axis.axhline(0, color=GREY, linewidth=0.5)
    settled = np.concatenate([error, bound]).reshape(2, -1)[:, len(error) // 3 :]
    limit = 1.1 * float(np.max(np.abs(settled), where=np.isfinite(settled), initial=0.0)) or 1.0
    axis.set_ylim(-limit, limit)
    axis.locator_params(axis="y", nbins=5)
    axis.set_ylabel(f"error {index + 1} [{unit('rate')}]")


def _range(values: Array) -> tuple[float, float]:
    """Return limits that hold nearly all values with some room, finite whatever the values are."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return (-1.0, 1.0)
    low, high = np.percentile(finite, (0.5, 99.5))
    room = 0.15 * (high - low) or 1.0
    return (float(low - room), float(high + room))


def _handles(with_truth: bool) -> list[Line2D | Patch]:
    lines = [
        Line2D([], [], color=colour, label=f"axis {index + 1}")
        for index, colour in zip(_AXES, AXIS_COLOURS)
    ]
    band = Patch(facecolor=GREY, alpha=0.3, linewidth=0, label="±3σ")
    truth = Line2D([], [], label="truth", **TRUTH)
    return [*lines, band, *([truth] if with_truth else [])]
