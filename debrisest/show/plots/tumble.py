"""An animation of the tumble: the target's features as they are and as they were estimated."""

from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from debrisest.arrays import Array, Data
from debrisest.attitude import quaternion
from debrisest.attitude.points import features_frame
from debrisest.files import put
from debrisest.results.results import Results
from debrisest.scenario.load import LoadedScenario
from debrisest.show.plots.axes import heading
from debrisest.show.plots.gather import Source, single_runs
from debrisest.show.plots.png import picture
from debrisest.show.plots.room import make_room
from debrisest.show.plots.space import same_scale, spatial_axes
from debrisest.show.plots.style import BLUE, GREY, VERMILION, style

DATASETS = ("true_point_b", "true_q_ib", "q_if")
FRAMES = 60
_DPI, _SIZE, _MILLISECONDS = 80, 5.0, 120
_RAYS: dict[str, Any] = {"color": GREY, "linewidth": 0.5}
_TRUE: dict[str, Any] = {"linestyle": "", "marker": "o", "color": BLUE, "markerfacecolor": "none"}
_ESTIMATED: dict[str, Any] = {"linestyle": "", "marker": "x", "color": VERMILION}


def places(data: Data) -> tuple[Array, Array]:
    """Return true and estimated places (time, feature, 3) of the features, inertial axes.

    The estimate turns the true shape by ``q_if (time, 4)``: what differs is the attitude.
    """
    points_b = data["true_point_b"]
    points_f = points_b @ features_frame(points_b)
    true = quaternion.rotate(data["true_q_ib"][:, None], points_b)
    return true, quaternion.rotate(data["q_if"][:, None], points_f)


def tumbles(scenario: LoadedScenario, results: Results) -> Iterator[Source]:
    """Return what a film needs, of every case and estimator that has it."""
    for source in single_runs(scenario, results, {}):
        if set(DATASETS) <= set(source.data):
            yield source


def write_tumble(source: Source, folder: Path) -> Path:
    """Write a GIF of ``FRAMES`` epochs, spread evenly over the time, in one step."""
    path = folder / ("-".join(("tumble", *source.names)) + ".gif")
    with style():
        first, *others = _frames(source.data, source.context)
    film = BytesIO()
    first.save(film, "gif", save_all=True, append_images=others, duration=_MILLISECONDS, loop=0)
    put(path, film.getvalue())
    return path


def _frames(data: Data, context: str) -> Iterator[Any]:
    (true, estimated), times = places(data), data["time_s"]
    figure = Figure(figsize=(_SIZE, _SIZE))
    top, axes = spatial_axes(figure, ("x", "y", "z"))
    reach = np.full((1, 3), np.linalg.norm(data["true_point_b"], axis=-1).max())
    same_scale(axes, np.concatenate([-reach, reach]))
    heading(top, "Tumble, inertial axes: true (o), estimated (x)", context)
    lines = [axes.plot([], [], [], **look)[0] for look in (_RAYS, _TRUE, _ESTIMATED)]
    time = axes.text2D(0.02, 0.95, "", transform=axes.transAxes)
    make_room(figure)
    for epoch in np.linspace(0, len(times) - 1, min(FRAMES, len(times))).astype(int):
        spokes = np.insert(true[epoch], range(len(true[epoch])), 0.0, axis=0)
        for line, points in zip(lines, (spokes, true[epoch], estimated[epoch])):
            line.set_data_3d(*points.T)
        time.set_text(f"{times[epoch]:g} s")
        yield picture(figure, _DPI)
