"""How a statistic over runs differs between two sets of runs, with a bootstrap interval."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.assessment.intervals import CONFIDENCE
from debrisest.assessment.statistics import STATISTICS

RESAMPLES = 2000
FEWEST = 6
"""Pairs below which no difference is shown: the signs of five agree by chance once in 16 times."""


class Difference(NamedTuple):
    """The statistic of both sets, and the interval of the second minus the first."""

    first: float
    second: float
    low: float
    high: float

    @property
    def width(self) -> float:
        """Return the width of the interval."""
        return self.high - self.low


def difference(
    name: str, first: Sequence[Array], second: Sequence[Array], paired: bool, seed: int
) -> Difference:
    """Return how a statistic over runs, averaged over groups, differs.

    Each group holds the figures (run,) of one case. ``paired`` figures are of the same runs, which
    are resampled together, so that what both have in common cancels; the others are resampled
    apart. NaN where a group is empty.
    """
    over_runs = STATISTICS[name].over_runs
    groups = [*first, *second]
    if not groups or any(len(group) == 0 for group in groups):
        return Difference(*[np.nan] * 4)
    rng = np.random.default_rng(seed)
    resampled = []
    for one, other in zip(first, second):
        mine = _chosen(rng, len(one))
        others = mine if paired else _chosen(rng, len(other))
        resampled.append(over_runs(other[others]) - over_runs(one[mine]))
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(np.mean(resampled, axis=0), [tail, 1 - tail])
    of_both = [np.mean([over_runs(group) for group in groups]) for groups in (first, second)]
    return Difference(*map(float, (*of_both, low, high)))


def _chosen(rng: np.random.Generator, runs: int) -> IntArray:
    """Return the runs (resample, run) that are drawn with replacement."""
    return rng.integers(runs, size=(RESAMPLES, runs))
