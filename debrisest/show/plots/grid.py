"""Panels in rows and columns below one heading."""

from typing import Any, Literal

import numpy as np
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
    panels: NDArray[Any] = np.empty((rows, columns), dtype=object)
    for row, column in np.ndindex(rows, columns):
        first = {"row": panels[row, 0], True: panels[0, 0]}.get(sharey)
        panel = figure.add_subplot(grid[row + 1, column], sharey=first)
        if first is not None and column:
            panel.tick_params(labelleft=False)
        panels[row, column] = panel
    return top, panels
