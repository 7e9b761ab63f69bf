"""Room around axes for what stands there: every axis is measured once, then all are placed.

Matplotlib's own engines lay a figure out twice or more, each time with all ticks and texts, which
takes longer than drawing it. Figures here are one grid, with a heading above and a legend below.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg, RendererAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox, offset_copy

from debrisest.arrays import Array
from debrisest.show.plots.style import style

_PAD = 0.06
"""Between what belongs to different axes, and at the figure's border, inches."""


class _Part(NamedTuple):
    """Axes with their place in the grid, and how far what is around them reaches, pixels."""

    axes: Axes
    rows: tuple[int, int]
    columns: tuple[int, int]
    reach: Array
    """To the left, below, to the right and above (4,)."""
    ticks: Array
    """The same of ticks alone."""


def make_room(figure: Figure) -> None:
    """Place all axes of a figure's grid, and their labels, so that nothing covers anything."""
    canvas: Any = FigureCanvasAgg(figure)
    renderer = canvas.get_renderer()
    shown = [axes for axes in figure.axes if axes.get_visible()]
    before: list[list[float]] = []
    with style():
        for _ in range(2):  # other sizes may have other ticks
            if (ticks := [_ticks(axes) for axes in shown]) != before:
                _place(figure, [_part(axes, renderer) for axes in shown], renderer)
            before = ticks


def _ticks(axes: Axes) -> list[float]:
    both = (axes.xaxis, axes.yaxis)
    return [float(tick) for axis in both for tick in axis.get_majorticklocs()]


def _part(axes: Axes, renderer: RendererAgg) -> _Part:
    spec = axes.get_subplotspec()
    assert spec is not None
    rows, columns = spec.rowspan, spec.colspan
    axes.apply_aspect()
    ticks = _reach(axes, _ticks_of(axes, renderer))
    reach = np.maximum(ticks, _reach(axes, _texts_of(axes, renderer)))
    return _Part(axes, (rows.start, rows.stop), (columns.start, columns.stop), reach, ticks)


def _reach(axes: Axes, boxes: Iterable[Bbox]) -> Array:
    """Return how far boxes reach out of axes (4,), pixels."""
    low, high = Bbox.union([axes.bbox, *boxes]).get_points() - axes.bbox.get_points()
    return np.maximum([*-low, *high], 0.0)


def _ticks_of(axes: Axes, renderer: RendererAgg) -> Iterator[Bbox]:
    """Yield the boxes of ticks without labels; of spatial axes, of all there is."""
    if axes.name != "rectilinear":
        yield axes.get_tightbbox(renderer, for_layout_only=True) or axes.bbox
        return
    for axis in (axes.xaxis, axes.yaxis) if axes.axison else ():
        axis.set_label_coords(0.5, 0.5)  # else it is looked for, with all ticks once more
        axis.label.set_visible(False)
        yield axis.get_tightbbox(renderer) or axes.bbox
        axis.label.set_visible(True)


def _texts_of(axes: Axes, renderer: RendererAgg) -> Iterator[Bbox]:
    """Yield how high and how low titles and texts are; how wide does not count."""
    for text in axes.get_children() if axes.name == "rectilinear" else ():
        if isinstance(text, Text) and text.get_visible() and text.get_text():
            box = text.get_window_extent(renderer)
            yield Bbox([[axes.bbox.x0, box.y0], [axes.bbox.x0, box.y1]])


def _place(figure: Figure, parts: Sequence[_Part], renderer: RendererAgg) -> None:
    grid = parts[0].axes.get_gridspec()
    assert grid is not None
    _label(parts, renderer)
    pad, (width, height) = _PAD * figure.dpi, figure.bbox.size
    legends = sum(legend.get_window_extent(renderer).height + pad for legend in figure.legends)
    spans = [(part.columns, part.reach[[0, 2]]) for part in parts]
    x = _edges(spans, grid.get_width_ratios(), width, pad, 0.0)
    spans = [(part.rows, part.reach[[3, 1]]) for part in parts]
    y = 1.0 - _edges(spans, grid.get_height_ratios(), height, pad, legends)
    for part in parts:
        (row, below), (column, beside) = part.rows, part.columns
        corners = [[x[0, column], y[1, below - 1]], [x[1, beside - 1], y[0, row]]]
        part.axes.set_position(Bbox(corners))


def _label(parts: Sequence[_Part], renderer: RendererAgg) -> None:
    """Put labels beyond the ticks, in line with others of their row or column, and add room."""
    dpi = renderer.dpi
    for part in parts:
        for axis, side in ((part.axes.xaxis, 1), (part.axes.yaxis, 0)):
            if part.axes.name == "rectilinear" and axis.get_label_text():
                alike = [one for one in parts if _line(one, side) == _line(part, side)]
                away = max(one.ticks[side] for one in alike) + axis.labelpad * dpi / 72
                _put(axis, side, away / dpi)
                thick = axis.label.get_window_extent(renderer).size[side]
                part.reach[side] = max(part.reach[side], away + thick)


def _line(part: _Part, side: int) -> int:
    return part.columns[0] if side == 0 else part.rows[1]


def _put(axis: Axis, side: int, inches: float) -> None:
    """Put a label so far to the left of its axes, or below."""
    axes, at = axis.axes, (0.0, 0.5) if side == 0 else (0.5, 0.0)
    figure = axes.get_figure(root=True)
    shift = (-inches, 0.0) if side == 0 else (0.0, -inches)
    axis.set_label_coords(*at, offset_copy(axes.transAxes, figure, *shift))


def _edges(
    spans: Sequence[tuple[tuple[int, int], Array]],
    ratios: Any,
    length: float,
    pad: float,
    kept: float,
) -> Array:
    """Return where each row or column begins and ends (2, n), as shares of the length.

    Each has what reaches out of it before and behind; what is left is divided as the ratios say.
    """
    before, behind = np.zeros((2, len(ratios)))
    for (first, last), (out, over) in spans:
        before[first] = max(before[first], out)
        behind[last - 1] = max(behind[last - 1], over)
    left = length - kept - 2 * pad * len(ratios) - before.sum() - behind.sum()
    sizes = max(left, 1.0) * np.asarray(ratios) / np.sum(ratios)
    ends = np.cumsum(before + sizes + behind + 2 * pad) - pad - behind
    return np.asarray([ends - sizes, ends]) / length
