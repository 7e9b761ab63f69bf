"""Room around axes, held to matplotlib's own boxes of all that it draws."""

from itertools import combinations

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from debrisest.show.plots.axes import heading, legend_below
from debrisest.show.plots.grid import headed_grid
from debrisest.show.plots.pose_errors import pose_errors
from debrisest.show.plots.room import make_room
from debrisest.show.plots.space import same_scale, spatial_axes
from debrisest.show.plots.style import styled

LONG = "a context of many words, " * 8


def _pose() -> Figure:
    rng, times = np.random.default_rng(1), np.arange(50.0)
    names = {"position_error": 1e-9, "velocity_error": 1e6, "rate_error": 0.3}
    return pose_errors(
        {"time_s": times, **{n: s * rng.standard_normal((50, 3)) for n, s in names.items()}}, LONG
    )


@styled
def _uneven() -> Figure:
    figure = Figure(figsize=(7.2, 6.0))
    axes = figure.subplots(3, height_ratios=(1, 2, 1))
    for axis, scale in zip(axes, (1e-12, 1.0, 12345.678)):
        line = axis.plot([0, 1], [scale, -3 * scale], label="line")
        axis.set_ylabel("a label [km]")
    axes[1].set_title("a title of its own")
    axes[2].set_xlabel("time [s]")
    heading(axes[0], "Title", LONG)
    legend_below(figure, line)
    return figure


@styled
def _panels() -> Figure:
    figure = Figure(figsize=(7.2, 5.0))
    top, grid = headed_grid(figure, 2)
    for axis in grid.flat:
        axis.plot([0, 1000], [1, 2])
        axis.set(xlabel="below", ylabel="beside")
    heading(top, "Title", "context")
    return figure


@styled
def _space() -> Figure:
    figure = Figure(figsize=(7.2, 5.6))
    top, axes = spatial_axes(figure, ("x", "y", "z"))
    same_scale(axes, np.array([[0.0, 0, 0], [1, 2, 5]]))
    heading(top, "Title", "context")
    return figure


def _boxes(figure: Figure) -> list[Bbox]:
    """What matplotlib says that all visible axes and legends take, without headings' widths."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    shown = [axes for axes in figure.axes if axes.get_visible()]
    boxes = [axes.get_tightbbox(renderer, for_layout_only=True) for axes in shown]
    return [*boxes, *(legend.get_window_extent(renderer) for legend in figure.legends)]


@pytest.mark.parametrize("make", [_pose, _uneven, _panels, _space])
def test_nothing_covers_anything_and_all_is_in_the_figure(make: object) -> None:
    figure = make()
    make_room(figure)
    boxes = _boxes(figure)
    whole = figure.bbox.padded(1.0)
    assert all(whole.containsx(x) for box in boxes for x in box.intervalx)
    assert all(whole.containsy(y) for box in boxes for y in box.intervaly)
    for one, other in combinations([box for box in boxes if box.width > 2], 2):
        shared = Bbox.intersection(one, other)
        assert shared is None or min(shared.size) < 1.0


def test_without_it_something_does() -> None:
    boxes = [box for box in _boxes(_pose()) if box.width > 2]
    shared = [Bbox.intersection(*pair) for pair in combinations(boxes, 2)]
    assert any(each is not None and min(each.size) > 1.0 for each in shared)


def test_labels_of_a_column_are_in_line_and_heights_as_asked_for() -> None:
    figure = _uneven()
    make_room(figure)
    renderer = FigureCanvasAgg(figure).get_renderer()
    right = [axes.yaxis.label.get_window_extent(renderer).x1 for axes in figure.axes]
    assert np.ptp(right) < 1.0
    heights = [axes.get_position().height for axes in figure.axes]
    np.testing.assert_allclose(heights[1], 2 * np.array(heights)[[0, 2]])
