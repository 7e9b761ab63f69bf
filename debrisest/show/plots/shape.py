"""True and estimated points of one run at its end (Volpe et al. 2017, Fig. 7)."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from debrisest.arrays import Array, Data
from debrisest.assessment.shape_alignment import best_rotation
from debrisest.show.plots.axes import heading, legend_below
from debrisest.show.plots.space import same_scale, spatial_axes
from debrisest.show.plots.style import BLUE, INK, VERMILION, WIDTH, styled

_TRUE: dict[str, Any] = {"marker": "o", "markersize": 6.0, "color": BLUE, "markerfacecolor": "none"}
_ESTIMATED: dict[str, Any] = {"marker": "x", "markersize": 5.0, "color": VERMILION}
_ALIGNED: dict[str, Any] = {"marker": ".", "markersize": 4.0, "color": INK}
DATASETS = ("point_b", "reference_point_b")


@styled
def shape(data: Data, context: str) -> Figure:
    """Draw ``reference_point_b`` (feature, 3) and the last of ``point_b`` (time, feature, 3).

    Estimates are shown as they are and after their best rotation about the centre of mass.
    """
    true, estimated = data["reference_point_b"], _last(data["point_b"])
    turned = estimated @ best_rotation(estimated, true).T
    figure = Figure(figsize=(WIDTH, 5.6))
    top, axes = spatial_axes(figure, ("x", "y", "z"))
    for points, look in ((true, _TRUE), (estimated, _ESTIMATED), (turned, _ALIGNED)):
        axes.plot(*points.T, linestyle="", **look)
    for pair in zip(true, estimated):
        axes.plot(*np.array(pair).T, color=VERMILION, linewidth=0.8)
    same_scale(axes, np.concatenate([true, estimated]))
    heading(top, "Points in body axes at the end", context)
    legend_below(figure, _handles())
    return figure


def _last(points: Array) -> Array:
    """Return the last estimate (feature, 3) of every point (time, feature, 3) that has one."""
    known = np.isfinite(points).all(-1)
    last = np.where(known, np.arange(len(points))[:, None], 0).max(axis=0)
    return np.asarray(points[last, np.arange(points.shape[1])])


def _handles() -> list[Line2D]:
    return [
        Line2D([], [], linestyle="", label="true", **_TRUE),
        Line2D([], [], linestyle="", label="estimated", **_ESTIMATED),
        Line2D([], [], linestyle="", label="estimated, after the best rotation", **_ALIGNED),
    ]
