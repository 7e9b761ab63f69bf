"""The target with its features, and how often each of them was seen."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from debrisest.arrays import BoolArray, Data
from debrisest.show.plots.axes import heading, legend_below
from debrisest.show.plots.space import same_scale, spatial_axes
from debrisest.show.plots.style import BLUE, GREY, INK, WIDTH, styled

DATASETS = ("true_point_b", "measured_point")


@styled
def target(data: Data, context: str) -> Figure:
    """Draw ``true_point_b (feature, 3)`` in body axes; filled are those seen at the first epoch.

    Beside its name stands the share of the epochs at which ``measured_point`` has a feature.
    """
    points = data["true_point_b"]
    seen: BoolArray = np.asarray(np.isfinite(data["measured_point"]).all(axis=-1))
    names = data.get("feature", np.arange(1, len(points) + 1))
    figure = Figure(figsize=(WIDTH, 5.6))
    top, axes = spatial_axes(figure, ("x", "y", "z"))
    for point, name, share, now in zip(points, names, seen.mean(axis=0), seen[0]):
        axes.plot(*np.array([np.zeros(3), point]).T, color=GREY, linewidth=0.5)
        axes.plot(*point[:, None], linestyle="", marker="o", **_look(bool(now)))
        axes.text(*point, f"  {name} {100 * share:.0f} %", fontsize=7.5, color=INK)
    same_scale(axes, np.concatenate([points, np.zeros((1, 3))]))
    heading(top, "Target in body axes, share of epochs at which a feature is seen", context)
    legend_below(figure, _handles())
    return figure


def _look(seen: bool) -> dict[str, Any]:
    return {"color": BLUE, "markersize": 6.0, "markerfacecolor": BLUE if seen else "white"}


def _handles() -> list[Line2D]:
    told = {"seen at the first epoch": True, "not seen": False}
    lines = [Line2D([], [], linestyle="", marker="o", label=n, **_look(s)) for n, s in told.items()]
    return [*lines, Line2D([], [], color=GREY, linewidth=0.5, label="from the centre of mass")]
