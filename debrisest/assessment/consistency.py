"""Whether an estimator's errors are as large as it says they are.

NEES and NIS are normalised squares that follow a chi-square distribution, with as many degrees of
freedom as there are errors, or innovations, if the covariances are right. The chart-free statistic
compares costs instead, which no choice of coordinates for the errors can bend.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array

CONFIDENCE = 0.95


class Verdict(NamedTuple):
    """A mean of normalised squares per degree of freedom, its interval if consistent, in words."""

    mean: float
    low: float
    high: float
    words: str


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
    solved = np.linalg.solve(filled, weighted[..., None])[..., 0]
    return np.where(sound, (weighted * solved).sum(-1), np.nan)


def chart_free(cost_of_truth: Array, cost_of_estimate: Array, n: int) -> Array:
    """``W = [C(truth) - C(map)] / n``, whose mean is 1 for a maximum a posteriori estimate.

    Costs are twice negative logarithms of the posterior density, up to the same constant; ``n`` is
    the number of errors. A value below zero says that the estimate is no minimum.
    """
    return np.asarray((cost_of_truth - cost_of_estimate) / n)


def interval(freedom: Array, confidence: float = CONFIDENCE) -> tuple[Array, Array]:
    """Two-sided chi-square interval per degree of freedom of ``freedom`` degrees in all."""
    from scipy.stats import chi2

    tail = 0.5 * (1.0 - confidence)
    count = np.asarray(freedom, dtype=np.float64)
    return np.asarray(chi2.ppf(tail, count) / count), np.asarray(chi2.isf(tail, count) / count)


def verdict(squares: Array, freedom: Array | int, confidence: float = CONFIDENCE) -> Verdict:
    """Judge independent normalised squares (any shape), each with its degrees of freedom.

    Squares of different runs are independent; those of one run at different epochs are so for NIS,
    not for NEES. NaN and squares without freedom do not count.
    """
    counts = np.broadcast_to(np.asarray(freedom, dtype=np.float64), np.shape(squares))
    used = np.isfinite(squares) & (counts > 0)
    total = float(counts[used].sum())
    if total == 0.0:
        return Verdict(np.nan, np.nan, np.nan, "unknown: nothing to judge by")
    mean = float(squares[used].sum() / total)
    low, high = (float(bound) for bound in interval(np.asarray(total), confidence))
    if mean > high:
        words = "over-confident: the errors are larger than the covariance says"
    elif mean < low:
        words = "over-cautious: the errors are smaller than the covariance says"
    else:
        words = "consistent"
    return Verdict(mean, low, high, words)
