"""The recovered attitude signal over the samples it comes from (Biondi et al. 2017, Figs. 8, 9)."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from debrisest.arrays import Array, Data
from debrisest.assessment.attitude import true_feature_attitude
from debrisest.recovery.pieces import continuous
from debrisest.show.plots.axes import heading, legend_below, quaternion_axis, shade_gaps, time_axis
from debrisest.show.plots.style import SHADE, SKY, TRUTH, VERMILION, WIDTH, styled

LAST_S = 300.0
"""Length of the close-up of the signal's end, seconds."""


class _Look(NamedTuple):
    """Sizes for a signal that is seen from far or from near."""

    line: float
    samples: dict[str, Any]


_WHOLE = _Look(0.9, {"markersize": 2.6, "mew": 0.5})
_CLOSE = _Look(1.4, {"markersize": 4.6, "mew": 0.8})
_CROSSES: dict[str, Any] = {"linestyle": "", "marker": "x", "color": SKY}


@styled
def recovered_quaternion(data: Data, context: str) -> Figure:
    """Draw all of q0 on top, and all components of ``q_if`` (time, 4) over the last 300 s."""
    times = data["time_s"]
    figure = Figure(figsize=(WIDTH, 7.2))
    whole, *close = figure.subplots(5, height_ratios=(1.2, 1, 1, 1, 1))
    samples, truth = _signed_samples(data), _truth(data)
    _component(whole, 0, data, samples, truth, _WHOLE)
    for component, axis in enumerate(close):
        _component(axis, component, data, samples, truth, _CLOSE)
    time_axis([whole], times, label=False)
    time_axis(close, times, LAST_S)
    heading(whole, "Recovered quaternion", context)
    start, end = close[0].get_xlim()
    close[0].set_title(f"the last {end - start:g} s", pad=4)
    legend_below(figure, _handles(truth is not None))
    return figure


def _component(
    axis: Axes, component: int, data: Data, samples: Array, truth: Array | None, look: _Look
) -> None:
    times = data["time_s"]
    shade_gaps(axis, times, ~np.isfinite(data["piece"]))
    axis.plot(times, samples[:, component], **_CROSSES, **look.samples)
    axis.plot(times, data["q_if"][:, component], color=VERMILION, linewidth=look.line)
    if truth is not None:
        axis.plot(times, truth[:, component], **TRUTH)
    quaternion_axis(axis, component)


def _signed_samples(data: Data) -> Array:
    """Return the raw samples (time, 4) with the sign that the search gave to their piece."""
    piece, sign = data["piece"], data["sign"]
    index = np.where(np.isfinite(piece), piece, len(sign)).astype(np.int64)
    return np.asarray(data["raw_q_if"] * np.append(sign, np.nan)[index, None])


def _truth(data: Data) -> Array | None:
    """Return the continuous truth (time, 4), as a whole with the sign of the recovered signal."""
    if "true_q_ib" not in data or "true_point_b" not in data:
        return None
    one_run = {name: data[name][None] for name in ("true_q_ib", "true_point_b")}
    true = true_feature_attitude(one_run)[0]
    true = continuous(true, np.zeros(len(true), dtype=np.int64))
    return true if np.nansum(true * data["q_if"]) >= 0 else -true


def _handles(with_truth: bool) -> list[Line2D | Patch]:
    cross = Line2D([], [], linestyle="", marker="x", markersize=4.5, color=SKY)
    cross.set_label("raw samples, signs from the search")
    line = Line2D([], [], color=VERMILION, label="recovered")
    truth = Line2D([], [], label="truth", **TRUTH)
    return [cross, line, *([truth] if with_truth else []), Patch(facecolor=SHADE, label="gap")]
