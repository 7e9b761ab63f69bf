"""Control sections as shaded stretches of a time axis, and where each section lies."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from debrisest.arrays import Array, BoolArray
from debrisest.show.plots.axes import shade_gaps
from debrisest.show.plots.style import SHADE


def turning(section: Array) -> BoolArray:
    """Return the epochs (time,) at which cameras are turned."""
    return np.asarray(section % 2 == 1)


def shade_sections(axis: Axes, times: Array, section: Array) -> None:
    """Shade the epochs (time,) at which cameras are turned."""
    shade_gaps(axis, times, turning(section))


def shade_handle() -> Patch:
    """Return what the legend says of it."""
    return Patch(facecolor=SHADE, linewidth=0, label="cameras turn (C)")


def control_sections(times: Array, section: Array) -> list[tuple[float, float]]:
    """Return begin and end of every control section, in the order of time."""
    step = float(times[1] - times[0]) if len(times) > 1 else 1.0
    numbers = np.unique(section[turning(section)])
    spans = (times[section == number] for number in numbers)
    return [(float(span[0]), float(span[-1]) + step) for span in spans]
