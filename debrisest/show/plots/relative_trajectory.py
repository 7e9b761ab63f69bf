"""The chaser's path about its target, true and estimated (Volpe et al. 2017, Fig. 9c)."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from debrisest.arrays import Data
from debrisest.show.plots.axes import heading, legend_below
from debrisest.show.plots.space import same_scale, spatial_axes
from debrisest.show.plots.style import INK, TRUTH, VERMILION, WIDTH, styled

DATASETS = ("relative_position_h", "chaser_position_h")


@styled
def relative_trajectory(data: Data, context: str) -> Figure:
    """Draw ``relative_position_h`` (time, 3) over ``chaser_position_h``, target at the origin."""
    true, estimated = data["chaser_position_h"], data["relative_position_h"]
    figure = Figure(figsize=(WIDTH, 5.6))
    top, axes = spatial_axes(figure, ("radial", "along track", "normal"))
    axes.plot(*estimated.T, color=VERMILION, linewidth=1.2)
    axes.plot(*true.T, **TRUTH)
    axes.plot([0.0], [0.0], [0.0], linestyle="", marker="s", markersize=5, color=INK)
    axes.plot(*true[:1].T, linestyle="", marker="o", markersize=5, color=INK)
    same_scale(axes, np.concatenate([true, np.zeros((1, 3))]))
    heading(top, "Chaser relative to target, Hill frame", context)
    legend_below(figure, _handles())
    return figure


def _handles() -> list[Line2D]:
    mark: dict[str, Any] = {"linestyle": "", "color": INK, "markersize": 5}
    return [
        Line2D([], [], color=VERMILION, label="estimated"),
        Line2D([], [], label="truth", **TRUTH),
        Line2D([], [], marker="o", label="start", **mark),
        Line2D([], [], marker="s", label="target", **mark),
    ]
