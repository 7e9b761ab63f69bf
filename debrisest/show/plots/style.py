"""What all figures look like: sizes, colours, lines and letters."""

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from typing import Any, ParamSpec

import matplotlib as mpl
from matplotlib.figure import Figure

BLUE, VERMILION, GREEN, SKY = "#0072B2", "#D55E00", "#009E73", "#56B4E9"
"""Told apart with any kind of colour vision (after Okabe and Ito)."""
INK, GREY, SHADE, GRID = "#1a1a1a", "#6b6b6b", "#e4e4e4", "#ebebeb"
AXIS_COLOURS = (BLUE, VERMILION, GREEN)
ESTIMATOR_COLOURS = (
    *(BLUE, VERMILION, GREEN, "#CC79A7", "#E69F00", SKY),
    *(INK, "#8c564b", "#7f7f7f", "#6a3d9a", "#b15928", "#b2df8a"),
)
"""In their order in the scenario; the first six are told apart with any kind of colour vision."""
WIDTH = 7.2
"""Width of every figure, inches."""
TRUTH: dict[str, Any] = {"color": INK, "linewidth": 0.7, "dashes": (4, 3), "zorder": 4}
"""A truth is thin and dashed, over everything else."""
_BOUND: dict[str, Any] = {"color": INK, "linewidth": 1.2, "zorder": 5}
_DASHES = ((4, 2), (1, 1), (6, 1, 1, 1))

_SETTINGS: dict[Any, Any] = {
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
    "grid.color": GRID,
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
    "figure.facecolor": "white",
    "svg.hashsalt": "debrisest",
}

P = ParamSpec("P")
_is_set = ContextVar("_is_set", default=False)


def estimator_looks(estimators: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return a line's look for each estimator: colours, and dashes for those that are bounds."""
    colours = iter(ESTIMATOR_COLOURS * len(estimators))
    lines = {name: {"color": next(colours), "linewidth": 1.2} for name in estimators}
    bounds = (name for name in lines if name.endswith("bound"))
    return lines | {name: _BOUND | {"dashes": d} for name, d in zip(bounds, _DASHES)}


@contextmanager
def style() -> Iterator[None]:
    """Within this context everything is drawn in the style of this file, set once."""
    if _is_set.get():
        yield
        return
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        before = _is_set.set(True)
        try:
            yield
        finally:
            _is_set.reset(before)


@contextmanager
def collected_after() -> Iterator[None]:
    """Within this context no garbage is looked for, after it only what was made within.

    A figure is very many small objects, all of them in use until it is done: the search for others
    took a fifth of the time.
    """
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.collect(0)
            gc.enable()


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw a figure in the style of this file."""

    @wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with style():
            return draw(*args, **kwargs)

    return drawn
