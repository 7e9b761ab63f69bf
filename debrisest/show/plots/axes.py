"""What stands on and around the axes of all figures: heading, legend, time, units and gaps."""

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, MaxNLocator

from debrisest.arrays import Array, BoolArray
from debrisest.show.plots.style import INK, SHADE
from debrisest.vocabulary import VOCABULARY

_HEADING_COLUMNS = 86


def unit(name: str) -> str:
    """Return a quantity's unit as the tables print it."""
    return VOCABULARY[name].table_unit or VOCABULARY[name].unit


def heading(top: Axes, title: str, context: str) -> None:
    """Write the title above all axes, and below it in grey what the figure was drawn from."""
    lines = textwrap.wrap(context.replace("$", r"\$"), _HEADING_COLUMNS)
    top.set_title("\n".join(lines), pad=6)
    top.annotate(
        title,
        xy=(0, 1),
        xycoords="axes fraction",
        xytext=(0, 10 + 11 * len(lines)),
        textcoords="offset points",
        fontsize=11,
        fontweight="bold",
        color=INK,
    )


def legend_below(figure: Figure, handles: Sequence[Artist]) -> None:
    """Write one legend for all axes below them, where it hides nothing."""
    figure.legend(handles=list(handles), loc="outside lower center", ncols=len(handles))


def time_axis(axes: Sequence[Axes], times: Array, last: float = np.inf, label: bool = True) -> None:
    """Give axes that share their time its label below the lowest, up to the end of the last step.

    They begin ``last`` seconds before that end, or with the first of ``times`` (time,).
    """
    end = float(times[-1]) + _step(times)
    for axis in axes:
        axis.set_xlim(max(float(times[0]), end - last), end)
        axis.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 2.5, 5, 10]))
        axis.tick_params(labelbottom=axis is axes[-1])
    if label:
        axes[-1].set_xlabel("time [s]")


def quaternion_axis(axis: Axes, component: int) -> None:
    """Give the axis of a quaternion's component its range and its name."""
    axis.set_ylim(-1.12, 1.12)
    axis.set_yticks([-1, 0, 1])
    axis.set_ylabel(f"$q_{component}$")


def log_axis(axis: Axes) -> None:
    """Make the axis logarithmic, with labels at 1, 2 and 5 of every decade."""
    axis.set_yscale("log")
    axis.yaxis.set_minor_locator(LogLocator(subs=(2, 5)))
    axis.yaxis.set_major_formatter("{x:g}")
    axis.yaxis.set_minor_formatter("{x:g}")


def gaps(times: Array, missing: BoolArray) -> list[tuple[float, float]]:
    """Return start and length of every stretch of missing epochs (time,), to half a step around."""
    step = _step(times)
    edges = np.diff(np.concatenate([[0], missing.astype(np.int64), [0]]))
    first, last = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    return [
        (float(times[a]) - step / 2, float(times[b] - times[a]) + step) for a, b in zip(first, last)
    ]


def _step(times: Array) -> float:
    return float(times[1] - times[0]) if len(times) > 1 else 1.0


def shade_gaps(axis: Axes, times: Array, missing: BoolArray) -> None:
    """Shade the epochs without an observation over the whole height."""
    shade(axis, gaps(times, missing))


def shade(axis: Axes, spans: Sequence[tuple[float, float]]) -> None:
    """Shade stretches of time, each with its start and its length, over the whole height."""
    axis.broken_barh(
        spans,
        (0, 1),
        transform=axis.get_xaxis_transform(),
        facecolor=SHADE,
        linewidth=0,
        zorder=0,
    )
