"""Error of an estimated orbit with its 3-sigma band (Li et al. 2011, Fig. 3)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading, legend_below, time_axis
from debrisest.show.plots.sections import shade_handle, shade_sections
from debrisest.show.plots.style import AXIS_COLOURS, GREY, WIDTH, styled

DATASETS = ("debris_position_error", "debris_position_sigma", "section")
_KM = 1e-3


@styled
def orbit_error(data: Data, context: str) -> Figure:
    """Draw the error (time, 3) of each inertial component, and where cameras were turned."""
    times = data["time_s"]
    figure = Figure(figsize=(WIDTH, 5.6))
    axes = list(figure.subplots(3, sharex=True, sharey=True))
    error, bound = (_KM * data[DATASETS[0]], 3 * _KM * data[DATASETS[1]])
    for index, axis in enumerate(axes):
        shade_sections(axis, times, data["section"])
        _component(axis, times, error[:, index], bound[:, index], AXIS_COLOURS[index])
        axis.set_ylabel(f"{'xyz'[index]} error [km]")
    limit = _limit(error, bound)
    axes[0].set_ylim(-limit, limit)
    time_axis(axes, times)
    heading(axes[0], "Error of the debris' position", context)
    legend_below(figure, _handles())
    return figure


def _component(axis: Axes, times: Array, error: Array, bound: Array, colour: str) -> None:
    axis.fill_between(times, -bound, bound, color=colour, alpha=0.2, linewidth=0)
    axis.plot(times, error, color=colour, linewidth=1.0)
    axis.axhline(0, color=GREY, linewidth=0.5)


def _limit(error: Array, bound: Array) -> float:
    """Return what holds the whole error and its band."""
    seen = np.abs(np.concatenate([error, bound]))
    return 1.05 * float(np.max(seen, where=np.isfinite(seen), initial=0.0)) or 1.0


def _handles() -> list[Line2D | Patch]:
    return [
        Line2D([], [], color=GREY, linewidth=1.0, label="estimate minus truth"),
        Patch(facecolor=GREY, alpha=0.3, linewidth=0, label="±3σ"),
        shade_handle(),
    ]
