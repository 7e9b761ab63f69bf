"""Errors of one run's pose, rates and inertia.

Pesce et al. 2017, Figs. 5-10 and 17-20; Volpe et al. 2017, Figs. 6 and 8-10.
"""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from debrisest.arrays import Array, Data
from debrisest.show.plots.axes import heading, legend_below, time_axis, unit
from debrisest.show.plots.grid import headed_grid
from debrisest.show.plots.style import AXIS_COLOURS, GREY, WIDTH, styled
from debrisest.vocabulary import table_scale


class _Group(NamedTuple):
    """Components in one row of panels: their datasets, and the quantity whose unit they have.

    The sigma is the first of those named that there is. Components are numbered along all axes of
    the dataset after time, row by row; those from 0 on are shown unless told otherwise.
    """

    error: str
    sigmas: tuple[str, ...]
    quantity: str
    labels: tuple[str, ...]
    chosen: tuple[int, ...] = ()

    def shown(self, data: Data) -> bool:
        """Return whether it is there; a norm is shown where its components are not."""
        components = f"{self.error}_error"
        there = np.shape(data.get(self.error, 0.0))[:1] == data["time_s"].shape
        return there and components not in data

    def sigma(self, data: Data) -> Array | None:
        """Return the sigma (time, component), if it is there."""
        found = [self.of(data[name]) for name in self.sigmas if name in data]
        return found[0] if found else None

    def of(self, values: Array) -> Array:
        """Return the chosen components (time, component) of a dataset (time, ...)."""
        return values.reshape(len(values), -1)[:, list(self.chosen or range(len(self.labels)))]


_AXES = ("x", "y", "z")
_POSITION = ("position_sigma", "relative_position_h_sigma")
_VELOCITY = ("velocity_sigma", "relative_velocity_h_sigma")
_INERTIA, _LOG_RATIOS = ("inertia_b_sigma",), ("log_inertia_sigma",)
_GROUPS = (
    _Group("position_error", _POSITION, "position", _AXES),
    _Group("velocity_error", _VELOCITY, "velocity", _AXES),
    _Group("rate_error", ("rate_l_sigma", "rate_b_sigma"), "rate", _AXES),
    _Group("attitude_error", ("attitude_error_sigma",), "attitude", _AXES),
    _Group("first_point_error", ("first_point_error_sigma",), "points", _AXES),
    _Group("first_point_c_error", ("point_c_sigma",), "points", _AXES),
    _Group("attitude", (), "attitude", ("angle",)),
    _Group("points", (), "points", ("all points",)),
    _Group("inertia_ratio_error", ("inertia_ratio_sigma",), "k1", ("k1", "k2")),
    _Group("inertia_error", _INERTIA, "inertia_tensor", ("Ixx", "Iyy", "Izz"), (0, 4, 8)),
    _Group("inertia_error", _INERTIA, "inertia_tensor", ("Ixy", "Ixz", "Iyz"), (1, 2, 5)),
    _Group("log_inertia_error", _LOG_RATIOS, "inertia", ("s1", "s2", "s3")),
    _Group("log_inertia_error", _LOG_RATIOS, "inertia", ("s4", "s5"), (3, 4)),
)
_WORDS = {"k1": "inertia ratio", "inertia": "log-ratio", "inertia_tensor": "inertia"}
_FIRST_POINT = {
    "first_point_error": "first point",
    "first_point_c_error": "first point, camera",
}
DATASETS = tuple(dict.fromkeys(group.error for group in _GROUPS))
_UNDER_LABEL = 1.25
"""Room above what has one sign, so that it stays below its label."""
_SETTLED = 0.1
"""Part of the time, at the start, that the limits of the axes do not follow."""


@styled
def pose_errors(data: Data, context: str) -> Figure:
    """Draw the errors (time, component) that there are, with their 3-sigma bands if known."""
    times = data["time_s"]
    groups = [group for group in _GROUPS if group.shown(data)]
    figure = Figure(figsize=(WIDTH, 1.3 + 1.55 * len(groups)))
    top, grid = headed_grid(figure, len(groups), sharey="row")
    for row, group in zip(grid, groups):
        _group(list(row), group, data)
    for column in grid.T:
        time_axis([axis for axis in column if axis.get_visible()], times)
    heading(top, "Errors with 3-sigma bands", context)
    legend_below(figure, _handles(any(group.sigma(data) is not None for group in groups)))
    return figure


def _group(row: list[Axes], group: _Group, data: Data) -> None:
    scale = table_scale(group.quantity)
    error, sigma = scale * group.of(data[group.error]), group.sigma(data)
    bound = np.full_like(error, np.nan) if sigma is None else 3 * scale * sigma
    for index, (axis, label) in enumerate(zip(row, group.labels)):
        _component(axis, data["time_s"], error[:, index], bound[:, index], index)
        axis.text(0.97, 0.93, label, transform=axis.transAxes, ha="right", va="top")
    for axis in row[len(group.labels) :]:
        axis.set_visible(False)
    limit = _limit(data["time_s"], error, bound)
    both = bool(np.any(error < 0)) or sigma is not None
    row[0].set_ylim(*((-limit, limit) if both else (0.0, _UNDER_LABEL * limit)))
    row[0].locator_params(axis="y", nbins=5)
    shown = unit(group.quantity)
    name = _FIRST_POINT.get(group.error, group.quantity)
    name = _WORDS.get(name, name)
    row[0].set_ylabel(name if shown == "1" else f"{name} [{shown}]")


def _component(axis: Axes, times: Array, error: Array, bound: Array, index: int) -> None:
    colour = AXIS_COLOURS[index]
    if np.isfinite(bound).any():
        axis.fill_between(times, -bound, bound, color=colour, alpha=0.2, linewidth=0)
    axis.plot(times, error, color=colour, linewidth=0.9)
    axis.axhline(0, color=GREY, linewidth=0.5)


def _limit(times: Array, error: Array, bound: Array) -> float:
    """Return what holds all errors, and their bands, once the start is over."""
    settled = times >= times[0] + _SETTLED * (times[-1] - times[0])
    seen = np.abs(np.concatenate([error[settled], bound[settled]]))
    return 1.1 * float(np.max(seen, where=np.isfinite(seen), initial=0.0)) or 1.0


def _handles(with_sigma: bool) -> list[Line2D | Patch]:
    line = Line2D([], [], color=GREY, linewidth=0.9, label="estimate minus truth")
    band = Patch(facecolor=GREY, alpha=0.3, linewidth=0, label="±3σ")
    return [line, *([band] if with_sigma else [])]
