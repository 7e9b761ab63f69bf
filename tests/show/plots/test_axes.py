"""Gaps, units and the axis of time."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from debrisest.show.plots.axes import gaps, time_axis, unit


@given(
    missing=st.lists(st.booleans(), min_size=2, max_size=40),
    step=st.floats(0.01, 100.0),
    start=st.floats(-10.0, 10.0),
)
def test_gaps_cover_the_missing_epochs_and_no_other(
    missing: list[bool], step: float, start: float
) -> None:
    times = start + step * np.arange(len(missing))
    found = gaps(times, np.array(missing))
    covered = [any(a < t < a + length for a, length in found) for t in times]
    assert covered == missing
    assert sum(length for _, length in found) == pytest.approx(step * sum(missing))
    assert all(a + length < b for (a, length), (b, _) in pairwise(found))


def test_units_are_those_of_the_tables() -> None:
    assert unit("rate_1") == "deg/s"
    assert unit("attitude") == "deg"
    assert unit("orbit_position") == "m"


def test_time_goes_to_the_end_of_the_last_step() -> None:
    axes = list(Figure().subplots(2))
    time_axis(axes, np.arange(0.0, 60.0, 0.5))
    assert [axis.get_xlim() for axis in axes] == [(0.0, 60.0)] * 2
    assert [axis.get_xlabel() for axis in axes] == ["", "time [s]"]
    time_axis(axes, np.arange(0.0, 60.0, 0.5), last=20.0)
    assert axes[0].get_xlim() == (40.0, 60.0)
