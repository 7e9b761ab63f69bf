"""Whether an estimator's errors are as large as it says they are.

NEES and NIS are normalised squares that follow a chi-square distribution, with as many degrees of
freedom as there are errors, or innovations, if the covariances are right. The chart-free statistic
compares costs instead, which no choice of coordinates for the errors can bend. The interval of a
statistic is where that of a consistent estimator lies with a probability of 95 %.
"""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.assessment.chi_square import quantile, upper_quantile
from debrisest.filters.linear_algebra import solve

CONFIDENCE = 0.95
_MEANS, _MEDIANS = ("mean", "value", "rmse"), ("median", "p50")
_MEAN_SQUARES = ("rmse", "median")
"""Statistics that take a root mean square over the epochs of a window."""


def normalized_square(error: Array, covariance: Array) -> Array:
    """``e^T P^-1 e (...,)``, NEES of errors ``(..., n)`` or NIS of innovations; NaN if it has none.

    Errors and covariance are scaled first, since variances may span many orders of magnitude.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.diagonal(covariance, 0, -2, -1) ** -0.5
        scaled = scale[..., :, None] * covariance * scale[..., None, :]
        sound = np.asarray(np.isfinite(scaled).all((-2, -1)) & np.isfinite(error).all(-1))
        filled = np.where(sound[..., None, None], scaled, np.eye(error.shape[-1]))
        weighted = np.where(sound[..., None], scale * error, 0.0)
    solved = solve(filled, weighted[..., None])[..., 0]
    return np.where(sound, (weighted * solved).sum(-1), np.nan)


def chart_free(cost_of_truth: Array, cost_of_estimate: Array, n: IntArray | int) -> Array:
    """``W = [C(truth) - C(map)] / n``, whose mean is 1 for a maximum a posteriori estimate.

    Costs are twice negative logarithms of the posterior density, up to the same constant; ``n`` is
    the number of errors. A mean below its interval says that estimates are no minimum of their own
    cost, not that they are too cautious; so does any value below zero.
    """
    return np.asarray((cost_of_truth - cost_of_estimate) / n)


def interval(dof: Array, confidence: float = CONFIDENCE) -> tuple[Array, Array]:
    """Two-sided chi-square interval per degree of freedom of ``dof`` degrees in all."""
    tail = 0.5 * (1.0 - confidence)
    count = np.where(np.asarray(dof) > 0, dof, np.nan)
    return quantile(tail, count) / count, upper_quantile(tail, count) / count


def consistent_interval(
    statistic: str, groups: list[Array], confidence: float = CONFIDENCE
) -> tuple[float, float]:
    """Interval of a statistic over runs of squares per degree of freedom, averaged over groups.

    Each group holds the degrees of freedom (run,) of independent runs. The statistics are means and
    the medians, which a few outlying runs do not move; NaN for all others, and without any run.
    """
    if not groups or any(len(group) == 0 or not (group > 0).all() for group in groups):
        return np.nan, np.nan
    if statistic in _MEANS:
        low, high = interval(pooled(np.stack([pooled(group) for group in groups])), confidence)
        return float(low), float(high)
    if statistic in _MEDIANS:
        return _interval_of_medians(groups, confidence)
    return np.nan, np.nan


def dof_of_runs(statistic: str, dof: Array, white: bool) -> Array:
    """Degrees of freedom (run,) of a run's figure over the epochs of ``dof (run, epoch)``.

    ``white`` squares are independent between epochs, as innovations are. Others, as errors are, may
    all say the same: their mean is taken to spread like a single one, so that the interval is never
    too narrow. Epochs without freedom do not count. The mean square of several epochs follows no
    chi-square distribution: 0, as where there is no freedom at all.
    """
    known = dof > 0
    count = known.sum(-1)
    inverse = np.divide(1.0, dof, out=np.zeros(dof.shape), where=known).sum(-1)
    together = np.divide(count**2, inverse, out=np.zeros(len(count)), where=count > 0)
    if statistic in _MEAN_SQUARES:
        together = np.where(count == 1, together, 0.0)
    return np.asarray(together if white else together / np.maximum(count, 1))


def pooled(dof: Array) -> Array:
    """Degrees of freedom of the mean of independent squares, each over its own ``dof (n,)``.

    Their sum where all have the same number, else those of the chi-square distribution that has the
    mean's variance (Satterthwaite).
    """
    return np.asarray(len(dof) ** 2 / np.sum(1.0 / dof))


def _interval_of_medians(groups: list[Array], confidence: float) -> tuple[float, float]:
    """Interval of the mean of the groups' medians, which are independent.

    The distances from its middle to its ends are those of the groups, added in squares.
    """
    tail = 0.5 * (1.0 - confidence)
    at = np.array([tail, 0.5, 1.0 - tail])
    low, middle, high = np.transpose([_median_quantiles(group, at) for group in groups])
    centre, count = np.mean(middle), len(groups)
    below, above = np.linalg.norm(middle - low), np.linalg.norm(high - middle)
    return float(centre - below / count), float(centre + above / count)


def _median_quantiles(dof: Array, at: Array) -> Array:
    """Quantiles ``at`` these probabilities of the median of squares per degree of freedom.

    Of n uniform draws, n odd, the middle one follows Beta((n + 1) / 2, (n + 1) / 2); the mean of
    the two middle ones of an even n nearly follows the beta distribution of its variance,
    n / (4 (n + 1) (n + 2)). The median of two is their mean, a chi-square itself. Runs of different
    freedom are taken at their harmonic mean.
    """
    from scipy.special import betaincinv

    runs, together = len(dof), pooled(dof)
    if runs <= 2:
        return quantile(at, together) / together
    each = together / runs
    half = 0.5 * (runs + 1) if runs % 2 else 0.5 * ((runs + 1) * (runs + 2) / runs - 1)
    return quantile(betaincinv(half, half, at), each) / each
