"""Statistics against hand-computed values."""

import numpy as np
import pytest

from debrisest.assessment.intervals import with_interval
from debrisest.assessment.statistics import STATISTICS, per_run, window_mask

# three runs, four epochs
ERRORS = np.array([[3.0, -4.0, 0.0, 5.0], [1.0, 1.0, -1.0, -1.0], [0.0, 2.0, 2.0, 4.0]])
ALL = np.ones(4, dtype=bool)
RMS = [np.sqrt(50 / 4), 1.0, np.sqrt(24 / 4)]
ABSOLUTE = [3.0, 1.0, 2.0]

BY_HAND = {
    "rmse": (RMS, np.mean(RMS)),
    "rms": (RMS, np.sqrt((50 + 4 + 24) / 12)),
    "median": (RMS, np.sqrt(6)),
    "p50": (ABSOLUTE, 2.0),
    "p70": (ABSOLUTE, 2.4),
    "p90": (ABSOLUTE, 2.8),
    "p100": (ABSOLUTE, 3.0),
    "mean": ([1.0, 0.0, 2.0], 1.0),
    "value": ([1.0, 0.0, 2.0], 1.0),
    "share": ([1.0, 0.0, 2.0], 1.0),
    "ever": ([5.0, 1.0, 4.0], 10 / 3),
}


def test_every_statistic_has_a_hand_computed_value() -> None:
    assert BY_HAND.keys() == STATISTICS.keys()


@pytest.mark.parametrize("name", BY_HAND)
def test_statistics_by_hand(name: str) -> None:
    each, together = BY_HAND[name]
    assert per_run(name, ERRORS, ALL) == pytest.approx(each)
    assert with_interval(name, [per_run(name, ERRORS, ALL)])[0] == pytest.approx(together)


def test_only_the_window_counts() -> None:
    inside = np.array([False, True, True, False])
    assert per_run("rmse", ERRORS, inside) == pytest.approx([np.sqrt(8), 1.0, 2.0])


def test_a_figure_per_run_needs_no_window() -> None:
    settling = np.array([30.0, 10.0, 20.0])
    assert per_run("median", settling, np.zeros(4, dtype=bool)).tolist() == [30.0, 10.0, 20.0]
    assert with_interval("median", [settling])[0] == 20.0


@pytest.mark.parametrize(
    ("window", "inside"),
    [
        ((0.0, 2.0), [0, 1]),
        ((0.5, 2.5), [1, 2]),
        ((0.0, 4.0), [0, 1, 2, 3]),
        ((0.0, 0.0), [0]),
        ((4.0, 4.0), [3]),
        ((1.4, 1.4), [1]),
        ((9.0, 12.0), []),
    ],
)
def test_windows_are_half_open_and_instants_take_the_nearest_epoch(
    window: tuple[float, float], inside: list[int]
) -> None:
    assert np.flatnonzero(window_mask(np.arange(4.0), window)).tolist() == inside
