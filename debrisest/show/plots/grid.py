"""Panels in rows and columns below one heading."""

from typing import Any, Literal

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

COLUMNS = 3
_NO_HEIGHT = 1e-3


def headed_grid(
    figure: Figure, rows: int, sharey: Literal["none", "row"] = "none"
) -> tuple[Axes, NDArray[Any]]:
    """Return axes over the whole width that only carry the heading, and panels (row, column)."""
    return panel_grid(figure, rows, COLUMNS, sharey)


def panel_grid(
    figure: Figure, rows: int, columns: int, sharey: Literal["none", "row"] | bool = "none"
) -> tuple[Axes, NDArray[Any]]:
    """Return the same for any number of columns."""
    ratios = [_NO_HEIGHT, *[1.0] * rows]
    grid = figure.add_gridspec(rows + 1, columns, height_ratios=ratios)
    top = figure.add_subplot(grid[0, :])
    top.set_axis_off()
    panels = grid[1:, :].subgridspec(rows, columns).subplots(squeeze=False, sharey=sharey)
    return top, panels
