"""What the tables say against the value of a key that cases differ in, such as a grid's."""

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from debrisest.arrays import Data
from debrisest.show.plots.axes import heading, log_axis
from debrisest.show.plots.grid import panel_grid
from debrisest.show.plots.style import GREY, INK, WIDTH, estimator_looks, styled

COLUMNS = (
    *("key", "value", "table", "estimator", "quantity", "unit", "statistic", "window"),
    *("measured", "ci_low", "ci_high", "published"),
)
"""Of cells of the tables, with the path of the key and its value."""
_ACROSS = 2
_LEGEND_COLUMNS = 5
_MANY_TIMES = 8.0
"""An axis whose largest value is so many times the smallest is logarithmic."""
_PUBLISHED: dict[str, Any] = {"color": INK, "marker": "D", "linestyle": "", "zorder": 6}
_PUBLISHED |= {"markersize": 4.5, "markerfacecolor": "none"}
ONE_PANEL = ["table", "quantity", "unit", "statistic", "window"]


@styled
def error_over_value(data: Data, context: str) -> Figure:
    """Draw ``measured (cell,)`` over ``value (cell,)``, a panel a quantity, a line an estimator.

    Bands are the 95 % intervals, as far as samples give them; bounds are dashed, published values
    are marks.
    """
    cells = pd.DataFrame({name: data[name] for name in COLUMNS})
    key, panels = str(cells["key"].iloc[0]), list(cells.groupby(ONE_PANEL, sort=False))
    across = min(_ACROSS, len(panels))
    rows = -(-len(panels) // across)
    figure = Figure(figsize=(WIDTH, 1.5 + 2.2 * rows))
    top, grid = panel_grid(figure, rows, across)
    looks = estimator_looks(list(dict.fromkeys(cells["estimator"])))
    for axis, ((table, quantity, unit, statistic, window), mine) in zip(grid.flat, panels):
        _panel(axis, mine, looks)
        axis.set_ylabel(f"{quantity}" + (f" [{unit}]" if unit != "1" else ""))
        axis.set_title(f"Table {table}: {statistic}, {window}")
        axis.set_xlabel(key.rpartition(".")[2])
    for axis in grid.flat[len(panels) :]:
        axis.set_visible(False)
    heading(top, f"Against {key}: what the tables say", context)
    handles = _handles(looks, bool(cells["published"].notna().any()))
    figure.legend(handles=handles, loc="outside lower center", ncols=_LEGEND_COLUMNS)
    return figure


def _panel(axis: Axes, cells: pd.DataFrame, looks: dict[str, dict[str, Any]]) -> None:
    _scale(axis, cells)
    for estimator, mine in cells.groupby("estimator", sort=False):
        look = looks[str(estimator)]
        axis.plot(mine["value"], mine["measured"], marker="o", markersize=3.0, **look)
        value, at, *ends = mine[["value", "measured", "ci_low", "ci_high"]].to_numpy(float).T
        low, high = (np.where(np.isfinite(end), end, at) for end in ends)
        axis.fill_between(value, low, high, color=look["color"], alpha=0.18, linewidth=0)
    known = cells.dropna(subset="published").drop_duplicates("value")
    axis.plot(known["value"], known["published"], **_PUBLISHED)


def _scale(axis: Axes, cells: pd.DataFrame) -> None:
    """Make axes logarithmic along which positive values differ by much."""
    values, figures = cells["value"], cells[["measured", "published"]].to_numpy(float)
    if _far(values.to_numpy(float)):
        axis.set_xscale("log")
        axis.set_xticks(values.unique(), [f"{value:g}" for value in values.unique()])
        axis.set_xticks([], minor=True)
    if _far(figures):
        log_axis(axis)
    axis.set_xmargin(0.04)


def _far(values: np.ndarray) -> bool:
    known = values[np.isfinite(values)]
    return len(known) > 0 and 0.0 < _MANY_TIMES * float(known.min()) <= float(known.max())


def _handles(looks: dict[str, dict[str, Any]], published: bool) -> list[Line2D | Patch]:
    lines = [Line2D([], [], label=name, **look) for name, look in looks.items()]
    band = Patch(facecolor=GREY, alpha=0.3, linewidth=0, label="95 % interval")
    return [*lines, band, *[Line2D([], [], label="published", **_PUBLISHED)] * published]
