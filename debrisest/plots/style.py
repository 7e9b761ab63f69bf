"""What all figures look like: sizes, colours, units on axes, gaps and headings."""

import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import wraps
from typing import Any, ParamSpec

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from debrisest.arrays import Array, BoolArray
from debrisest.vocabulary import VOCABULARY

BLUE, VERMILION, GREEN = "#0072B2", "#D55E00", "#009E73"
"""Told apart with any kind of colour vision (after Okabe and Ito)."""
INK, GREY, SHADE = "#1a1a1a", "#6b6b6b", "#ececec"
AXIS_COLOURS = (BLUE, VERMILION, GREEN)
WIDTH = 7.2
"""Width of every figure, inches."""
_HEADING_COLUMNS = 105

_SETTINGS = {
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.titlecolor": GREY,
    "axes.labelsize": 9,
    "axes.labelcolor": INK,
    "axes.edgecolor": GREY,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.xmargin": 0.0,
    "grid.color": "#e0e0e0",
    "grid.linewidth": 0.5,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "ytick.minor.width": 0.4,
    "lines.linewidth": 1.1,
    "lines.solid_joinstyle": "round",
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.handlelength": 1.8,
    "legend.columnspacing": 1.8,
    "figure.constrained_layout.use": True,
    "figure.constrained_layout.h_pad": 0.05,
    "figure.constrained_layout.w_pad": 0.06,
    "figure.facecolor": "white",
    "svg.hashsalt": "debrisest",
}

P = ParamSpec("P")


@contextmanager
def style() -> Iterator[None]:
    """Within this context everything is drawn in the style of this file."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        yield


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a figure in the style of this file."""

    @wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with style():
            return draw(*args, **kwargs)

    return drawn


def unit(name: str) -> str:
    """Return a quantity's unit as the tables print it."""
    return VOCABULARY[name].table_unit or VOCABULARY[name].unit


def heading(figure: Figure, top: Axes, title: str, context: str) -> None:
    """Write the title, and below it in grey what the figure was drawn from."""
    figure.suptitle(title, x=0.012, ha="left", fontsize=11, fontweight="bold", color=INK)
    top.set_title(textwrap.fill(context, _HEADING_COLUMNS), pad=7)


def legend_below(figure: Figure, handles: Sequence[Any]) -> None:
    """Write one legend for all axes below them, where it hides nothing."""
    figure.legend(handles=list(handles), loc="outside lower center", ncols=len(handles))


def time_axis(axes: Sequence[Axes], start: float, end: float) -> None:
    """Give axes that share their time from ``start`` to ``end`` one label, below the last."""
    for axis in axes:
        axis.set_xlim(start, end if end > start else start + 1)
        axis.tick_params(labelbottom=axis is axes[-1])
    axes[-1].set_xlabel("time [s]")


def gaps(times: Array, missing: BoolArray) -> list[tuple[float, float]]:
    """Return start and length of every stretch of missing epochs (time,), to half a step around."""
    half = 0.5 * float(times[1] - times[0]) if len(times) > 1 else 0.5
    edges = np.diff(np.concatenate([[0], missing.astype(np.int64), [0]]))
    first, last = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    return [(float(times[a]) - half, float(times[b] - times[a]) + 2 * half) for a, b in zip(first, last)]


def shade_gaps(axis: Axes, times: Array, missing: BoolArray) -> None:
    """Shade the epochs without an observation over the whole height."""
    axis.broken_barh(
        gaps(times, missing),
        (0, 1),
        transform=axis.get_xaxis_transform(),
        facecolor=SHADE,
        linewidth=0,
        zorder=0,
    )
