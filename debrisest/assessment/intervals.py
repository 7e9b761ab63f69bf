"""Confidence intervals of a statistic over runs: how far another sample of runs could lie.

The percentile bootstrap covers too seldom with few runs of skewed errors, so each kind of statistic
has its own interval here. An end that the sample cannot give, such as one above the largest of all
runs, is NaN.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.assessment.statistics import STATISTICS

CONFIDENCE = 0.95
_TAIL = (1 - CONFIDENCE) / 2
_LARGEST_TAIL = 0.035
"""An extreme of the sample is an end if it misses the quantile less often than this."""
_POWER, _POWER_OF_RMS = -1 / 3, -1.0
PERCENTILES = {"median": 0.5, "p50": 0.5, "p70": 0.7, "p90": 0.9, "p100": 1.0}
_SHARES = ("share", "ever")


class Spread(NamedTuple):
    """A mean with its standard error and the degrees of freedom of that."""

    mean: float
    error: float
    dof: float


def with_interval(name: str, groups: list[Array]) -> tuple[float, float, float]:
    """Return a statistic over runs, averaged over groups, and the ends of its 95 % interval.

    Each group holds the figures (run,) of one case: the cases are fixed, their runs are a sample.
    The measured figure is NaN where a group is empty, an end where the sample cannot give one.
    """
    if not groups or any(len(group) == 0 for group in groups):
        return (np.nan, np.nan, np.nan)
    middle = np.array([STATISTICS[name].over_runs(group) for group in groups])
    return (float(np.mean(middle)), *_ends(name, groups, middle))


def _ends(name: str, groups: list[Array], middle: Array) -> tuple[float, float]:
    if not all(np.isfinite(group).all() for group in groups):
        return np.nan, np.nan
    if name in PERCENTILES:
        return _joined(lambda group: _of_quantile(group, PERCENTILES[name]), middle, groups)
    if name in _SHARES and all(np.isin(group, (0.0, 1.0)).all() for group in groups):
        return _joined(_of_proportion, middle, groups)
    mean, half = reach(averaged([spread(name, group) for group in groups]))
    if any(np.min(group) <= 0 for group in groups):
        return mean - half, mean + half
    return _skewed(half / mean, mean, _POWER_OF_RMS if name == "rms" else _POWER)


def _joined(
    ends: Callable[[Array], tuple[float, float]], middle: Array, groups: list[Array]
) -> tuple[float, float]:
    """Ends of the mean of independent groups: their distances from the middles add in squares.

    Zou and Donner, "Construction of confidence limits about effect measures", 2008.
    """
    low, high = np.transpose([ends(group) for group in groups])
    below, above = np.linalg.norm(middle - low), np.linalg.norm(high - middle)
    centre, count = np.mean(middle), len(groups)
    return float(centre - below / count), float(centre + above / count)


def _of_quantile(figures: Array, share: float) -> tuple[float, float]:
    ordered = np.sort(figures)
    return _below(ordered, share), -_below(-ordered[::-1], 1 - share)


def _below(ordered: Array, share: float) -> float:
    """Value that is above the quantile of ``share`` in 2.5 % of samples.

    The order statistic r lies above it with the binomial probability of fewer than r figures below;
    between the two that enclose 2.5 % Nyblom's weights interpolate ("Note on interpolated order
    statistics", 1992).
    """
    from scipy.special import bdtr

    n = len(ordered)
    above = bdtr(np.arange(n), n, share)
    rank = int(np.searchsorted(above, _TAIL, side="right"))
    if rank == 0:
        return float(ordered[0]) if above[0] <= _LARGEST_TAIL else np.nan
    if rank == n:
        return np.nan
    weight = rank * (1 - share) * (above[rank] - _TAIL)
    weight /= weight + (n - rank) * share * (_TAIL - above[rank - 1])
    return float(weight * ordered[rank - 1] + (1 - weight) * ordered[rank])


def _of_proportion(figures: Array) -> tuple[float, float]:
    """Ends of the share of runs that have what only 0 and 1 tell (Wilson 1927)."""
    from scipy.special import ndtri

    n, share, z = len(figures), float(np.mean(figures)), float(ndtri(1 - _TAIL))
    centre = (share + z**2 / (2 * n)) / (1 + z**2 / n)
    half = z / (1 + z**2 / n) * np.sqrt(share * (1 - share) / n + z**2 / (4 * n**2))
    return float(np.clip(centre - half, 0, share)), float(np.clip(centre + half, share, 1))


def spread(name: str, figures: Array) -> Spread:
    """Return the mean over runs, or its root mean square, with its standard error."""
    n = len(figures)
    if n < 2:
        return Spread(float(np.mean(figures)), np.nan, np.nan)
    if name != "rms":
        return Spread(float(np.mean(figures)), float(np.std(figures, ddof=1) / np.sqrt(n)), n - 1)
    largest = float(np.max(np.abs(figures)))
    square = (figures / largest) ** 2 if largest > 0 else figures
    root = float(np.sqrt(np.mean(square)))
    error = np.std(square, ddof=1) / np.sqrt(n) / (2 * root) if root > 0 else 0.0
    return Spread(largest * root, float(largest * error), n - 1)


def averaged(parts: list[Spread]) -> Spread:
    """Return the mean of independent groups, with Satterthwaite's degrees of freedom."""
    mean, error, dof = np.transpose(parts)
    total = float(np.sum(error**2))
    if not total > 0:
        return Spread(float(np.mean(mean)), total, float(np.sum(dof)))
    together = total**2 / float(np.sum(error**4 / dof))
    return Spread(float(np.mean(mean)), float(np.sqrt(total) / len(parts)), together)


def reach(found: Spread) -> tuple[float, float]:
    """Return the mean and the half length of Student's interval."""
    from scipy.special import stdtrit

    return found.mean, found.error * float(stdtrit(found.dof, 1 - _TAIL))


def _skewed(reach: float, mean: float, power: float) -> tuple[float, float]:
    """Student's interval of a ``power`` of the mean; its half length is relative to the mean.

    Errors are skewed, and so is Student's statistic, the other way; the power -1/3 of the mean
    takes this away for figures that follow a gamma distribution (skewness twice the coefficient of
    variation), and most of it for lognormal ones. The squares of a root mean square are more
    skewed: -1/2 of their mean was measured to do best.
    """
    upper = 1 + power * reach
    low = mean * (1 - power * reach) ** (1 / power)
    return low, mean * upper ** (1 / power) if upper > 0 else np.nan
