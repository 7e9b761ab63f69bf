"""What the search for signs tried (Biondi et al. 2017, Figs. 5, 6, 7).

A hypothesis is named by its pieces after the first: 0 keeps the sign, 1 turns it.
"""

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from debrisest.arrays import Array, Data, IntArray
from debrisest.show.plots.axes import heading, legend_below, time_axis
from debrisest.show.plots.grid import panel_grid
from debrisest.show.plots.style import BLUE, GREY, SKY, VERMILION, WIDTH, styled

DATASETS = ("hypothesis_sign", "hypothesis_score", "hypothesis_q0", "raw_q_if", "piece")
_CROSSES: dict[str, Any] = {"linestyle": "", "marker": "x", "color": SKY, "markersize": 2.4}
_COLUMNS = 4


@styled
def first_hypotheses(data: Data, context: str) -> Figure:
    """Draw the signals recovered from the first pieces with all signs, the best ones in blue."""
    return _signals(data, _steps(data)[0], "Signs of the first pieces", context)


@styled
def next_hypotheses(data: Data, context: str) -> Figure:
    """Draw the signals of the best hypotheses with one more piece, of either sign."""
    return _signals(data, _steps(data)[-1], "One more piece with either sign", context)


@styled
def hypothesis_scores(data: Data, context: str) -> Figure:
    """Draw the penalties of the first hypotheses, those that were kept in blue."""
    tried = _steps(data)[0]
    figure = Figure(figsize=(WIDTH, 3.0))
    axis = figure.subplots()
    best = _best(data, tried)
    colours = [BLUE if number in best else GREY for number in tried]
    axis.bar(_labels(data, tried), data["hypothesis_score"][tried], color=colours)
    axis.tick_params(axis="x", rotation=90)
    axis.set_ylabel("penalty")
    axis.set_xlabel("turned pieces")
    heading(axis, "Penalties of the signs of the first pieces", context)
    return figure


def _signals(data: Data, tried: IntArray, title: str, context: str) -> Figure:
    rows = -(-len(tried) // _COLUMNS)
    figure = Figure(figsize=(WIDTH, 1.2 + 1.3 * rows))
    top, grid = panel_grid(figure, rows, _COLUMNS, sharey=True)
    best, labels = _best(data, tried), _labels(data, tried)
    last = int(np.isfinite(data["hypothesis_q0"][tried]).any(axis=0).sum())
    times = data["time_s"][:last]
    for axis in grid.flat[len(tried) :]:
        axis.set_visible(False)
    for axis, number, label in zip(grid.flat, tried, labels):
        axis.plot(times, _samples(data, number)[:last], **_CROSSES)
        colour = BLUE if number in best else VERMILION
        axis.plot(times, data["hypothesis_q0"][number, :last], color=colour)
        axis.set_ylim(-1.3, 1.3)
        axis.annotate(label, (0.02, 0.02), xycoords="axes fraction", fontsize=7)
        time_axis([axis], times, label=False)
    heading(top, title, context)
    legend_below(figure, _handles())
    return figure


def _steps(data: Data) -> list[IntArray]:
    """Return the numbers of the hypotheses of each step: those of as many pieces."""
    pieces = np.isfinite(data["hypothesis_sign"]).sum(axis=-1)
    return [np.flatnonzero(pieces == count) for count in np.unique(pieces[pieces > 0])]


def _best(data: Data, tried: IntArray) -> IntArray:
    """Return the two hypotheses of the lowest penalty."""
    return np.asarray(tried[np.argsort(data["hypothesis_score"][tried], kind="stable")[:2]])


def _labels(data: Data, tried: IntArray) -> list[str]:
    signs = data["hypothesis_sign"][tried][:, 1:]
    return ["".join("1" if s < 0 else "0" for s in row[np.isfinite(row)]) for row in signs]


def _samples(data: Data, number: int) -> Array:
    """Return the raw samples (time,) with the signs of a hypothesis."""
    piece, sign = data["piece"], data["hypothesis_sign"][number]
    index = np.where(np.isfinite(piece), piece, len(sign)).astype(np.int64)
    return np.asarray(data["raw_q_if"][:, 0] * np.append(sign, np.nan)[index])


def _handles() -> list[Line2D]:
    cross = Line2D([], [], label="raw samples with these signs", **_CROSSES | {"markersize": 4.5})
    lines = (("recovered, the two best", BLUE), ("recovered, the others", VERMILION))
    return [cross, *(Line2D([], [], color=colour, label=label) for label, colour in lines)]
