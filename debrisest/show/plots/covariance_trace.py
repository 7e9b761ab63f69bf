"""Trace of an estimated orbit's covariance (Li et al. 2011, Fig. 4)."""

import numpy as np
from matplotlib.figure import Figure

from debrisest.arrays import Data
from debrisest.show.plots.axes import heading, legend_below, time_axis
from debrisest.show.plots.sections import shade_handle, shade_sections
from debrisest.show.plots.style import BLUE, WIDTH, styled
from debrisest.vocabulary import table_scale


@styled
def covariance_trace(data: Data, context: str) -> Figure:
    """Draw the trace (time,), which adds km^2 of the position and km^2/s^2 of the velocity."""
    times = data["time_s"]
    trace = data["covariance_trace"] * table_scale("covariance_trace")
    figure = Figure(figsize=(WIDTH, 3.4))
    axis = figure.subplots()
    shade_sections(axis, times, data["section"])
    axis.set_yscale("log")
    axis.yaxis.set_major_formatter("{x:g}")
    axis.plot(times, np.where(trace > 0, trace, np.nan), color=BLUE, linewidth=1.4)
    axis.set_ylabel("trace [km² and km²/s²]")
    time_axis([axis], times)
    heading(axis, "Trace of the covariance of position and velocity", context)
    legend_below(figure, [shade_handle()])
    return figure
