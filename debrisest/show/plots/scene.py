"""The target as its chaser first sees it, with its points and axes (Volpe et al. 2017, Fig. 5)."""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from debrisest.arrays import Array, BoolArray, Data
from debrisest.attitude import quaternion
from debrisest.dynamics.relative_motion import hill_frame
from debrisest.show.plots.axes import heading, legend_below
from debrisest.show.plots.space import same_scale, spatial_axes
from debrisest.show.plots.style import BLUE, GREY, INK, VERMILION, WIDTH, styled

DATASETS = (
    *("true_point_b", "true_q_ib", "true_q_hc", "chaser_position_h"),
    *("orbit_position", "orbit_velocity", "measured_pixel"),
)


@styled
def scene(data: Data, context: str) -> Figure:
    """Draw ``true_point_b (feature, 3)`` about the centre of mass in the first image's axes.

    Filled points are in that image; the body's axes and the line to the chaser start in the centre.
    """
    points = in_first_image(data, data["true_point_b"])
    reach = 1.3 * float(np.linalg.norm(points, axis=-1).max())
    seen: BoolArray = np.asarray(np.isfinite(data["measured_pixel"][0, 0]).all(axis=-1))
    names = data.get("feature", np.arange(1, len(points) + 1))
    figure = Figure(figsize=(WIDTH, 5.6))
    top, axes = spatial_axes(figure, ("x", "y", "z (ahead)"))
    body = in_first_image(data, reach * np.eye(3))
    for axis, name in zip(body, "xyz"):
        axes.plot(*np.array([np.zeros(3), axis]).T, color=VERMILION, linewidth=1.0)
        axes.text(*axis, f"  {name}", fontsize=8, color=VERMILION)
    axes.plot([0, 0], [0, 0], [0, -reach], color=GREY, linewidth=1.0, linestyle="--")
    for point, name, now in zip(points, names, seen):
        axes.plot(*point[:, None], linestyle="", marker="o", **_look(bool(now)))
        axes.text(*point, f"  {name}", fontsize=7.5, color=INK)
    same_scale(axes, np.concatenate([points, body, reach * np.array([[0.0, 0.0, -1.0]])]))
    far = float(np.linalg.norm(data["chaser_position_h"][0]))
    heading(top, f"Target at the start, {far:.3g} m from the chaser, camera axes", context)
    legend_below(figure, _handles())
    return figure


def in_first_image(data: Data, vectors: Array) -> Array:
    """Turn vectors (..., 3) of the body's axes into those of the camera at the first epoch."""
    to_hill = hill_frame(data["orbit_position"][0], data["orbit_velocity"][0]).T
    turned = quaternion.rotate(data["true_q_ib"][0], vectors) @ to_hill.T
    return quaternion.rotate(quaternion.conjugate(data["true_q_hc"][0]), turned)


def _look(seen: bool) -> dict[str, Any]:
    return {"color": BLUE, "markersize": 6.0, "markerfacecolor": BLUE if seen else "white"}


def _handles() -> list[Line2D]:
    told = {"in the first image": True, "not in it": False}
    lines = [Line2D([], [], linestyle="", marker="o", label=n, **_look(s)) for n, s in told.items()]
    return [
        *lines,
        Line2D([], [], color=VERMILION, linewidth=1.0, label="body axes"),
        Line2D([], [], color=GREY, linewidth=1.0, linestyle="--", label="to the chaser"),
    ]
