"""How a statistic over runs differs between two sets of runs, with its interval."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.assessment.intervals import CONFIDENCE, PERCENTILES, averaged, reach, spread
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

    Each group holds the figures (run,) of one case. ``paired`` figures are of the same runs, so
    that what both have in common cancels. Means and root mean squares have Student's interval, with
    Satterthwaite's degrees of freedom; of percentiles no closed form knows the pairs, so that runs
    are drawn anew, pairs together. NaN where a group is empty, ends where it has one run.
    """
    groups = [*first, *second]
    if not groups or any(len(group) == 0 for group in groups):
        return Difference(*[np.nan] * 4)
    over_runs = STATISTICS[name].over_runs
    mine, others = (
        float(np.mean([over_runs(group) for group in part])) for part in (first, second)
    )
    if name in PERCENTILES:
        low, high = _resampled(over_runs, first, second, paired, seed)
        return Difference(mine, others, low, high)
    half = _half_length(name, first, second, paired)
    return Difference(mine, others, others - mine - half, others - mine + half)


def _half_length(name: str, first: Sequence[Array], second: Sequence[Array], paired: bool) -> float:
    """Return half the length of Student's interval of a mean or a root mean square."""
    ones, others = ([_terms(name, group) for group in part] for part in (first, second))
    if paired:
        return reach(averaged([spread("mean", b - a) for a, b in zip(ones, others)]))[1]
    return 2 * reach(averaged([spread("mean", group) for group in (*ones, *others)]))[1]


def _terms(name: str, figures: Array) -> Array:
    """Return terms (run,) whose mean is the statistic, to first order in its error."""
    root = float(STATISTICS["rms"].over_runs(figures)) if name == "rms" else 0.0
    return np.asarray((root + figures**2 / root) / 2) if root > 0 else figures


def _resampled(
    over_runs: Callable[[Array], Array],
    first: Sequence[Array],
    second: Sequence[Array],
    paired: bool,
    seed: int,
) -> tuple[float, float]:
    """Return the ends of the bootstrap's percentile interval."""
    rng = np.random.default_rng(seed)
    resampled = []
    for one, other in zip(first, second):
        mine = _chosen(rng, len(one))
        others = mine if paired else _chosen(rng, len(other))
        resampled.append(over_runs(other[others]) - over_runs(one[mine]))
    tail = (1 - CONFIDENCE) / 2
    low, high = np.quantile(np.mean(resampled, axis=0), [tail, 1 - tail])
    return float(low), float(high)


def _chosen(rng: np.random.Generator, runs: int) -> IntArray:
    """Return the runs (resample, run) that are drawn with replacement."""
    return rng.integers(runs, size=(RESAMPLES, runs))
