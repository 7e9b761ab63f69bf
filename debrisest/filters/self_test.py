"""What an estimate says of itself: tests that see what the size of the innovations does not.

Every test compares a statistic of each run with what a right model and a converged estimate give
by chance once in some ten thousand times at most, that of all scores together once in a thousand.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.linear_algebra import solve
from debrisest.filters.rivals import DECISIVE
from debrisest.filters.verdict import SelfTest, Verdict

SIGMAS = 5.0
"""Whose probability, of a normal distribution, is that of a square that is too large."""
_SIGMAS_OF_SCORES = 4.0
"""Of a normal distribution, once in 16 000 times."""
_CHANCE_OF_ALL = 1e-3
_ALIKE = 1e-6
"""Part of a score that is taken to be its own, so that others which are the same are no news."""
_CLAIMED = 2.0
"""Times the information that there is, above which a sigma is too small by more than 1.4."""


def cost_test(cost: Array, dof: Array | IntArray) -> SelfTest:
    """Test the cost (run,) at the estimate against its chi-square of ``dof (run,)``."""
    return SelfTest(
        cost / np.maximum(dof, 1),
        _mean_limit(dof),
        "the cost at the estimate is {value} per degree of freedom, where noise as it is said "
        "to be gives at most {limit}",
    )


def innovation_test(nis: Array, dof: Array | IntArray) -> SelfTest:
    """Test the squared innovations of a filter, ``(run, time)`` each, against their chi-square."""
    freedom = dof.sum(-1)
    return SelfTest(
        np.where(dof > 0, nis, 0.0).sum(-1) / np.maximum(freedom, 1),
        _mean_limit(freedom),
        "squared innovations are {value} of what the filter states in the mean, at most {limit} "
        "by chance",
    )


def block_test(sums: Array, fitted: float) -> SelfTest:
    """Test normalised sums of residuals over blocks of time, ``(run, ...)``, NaN where nothing is.

    Each is a unit normal variable but for what the estimate has ``fitted`` of them. Slow errors far
    below the noise of an epoch show here.
    """
    flat = sums.reshape(len(sums), -1)
    dof = np.maximum(np.isfinite(flat).sum(-1) - fitted, 1.0)
    return SelfTest(
        np.nansum(flat**2, axis=-1) / dof,
        _mean_limit(dof),
        "residuals last over blocks of time: the squares of their means are {value} of what noise "
        "has, at most {limit} by chance",
    )


def parts_test(part: Array, whole: Array, part_spread: Array, whole_spread: Array) -> SelfTest:
    """Test the estimate of a part of the data against that of all (Hausman), ``(run, n)``.

    That of all is efficient, so that the covariance of the difference is the difference of the
    covariances ``(run, n, n)``; only directions in which the rest of the data tells as much again
    count.
    """
    values, vectors = np.linalg.eigh(_relative(part_spread, whole_spread))
    root = np.asarray(np.linalg.cholesky(part_spread), dtype=np.float64)
    white = solve(root, (part - whole)[..., None])[..., 0]
    along = (np.swapaxes(vectors, -1, -2) @ white[..., None])[..., 0]
    told = values < 0.5
    squares = np.where(told, along**2 / np.where(told, 1.0 - values, 1.0), 0.0).sum(-1)
    dof = told.sum(-1)
    return SelfTest(
        squares / np.maximum(dof, 1),
        _mean_limit(dof),
        "the first part of the data and all of it disagree: the squared difference is {value} of "
        "what is stated, at most {limit} by chance",
    )


def rival_test(gap: Array) -> SelfTest:
    """Test by how much the mirror's cost is higher (run,); infinite or NaN where there is none."""
    return SelfTest(
        -gap,
        -DECISIVE,
        "the motion and another one, with its depth reversed, fit the images about as well; "
        "a longer arc, or a target that turns more, is needed to tell them apart",
        Verdict.AMBIGUOUS,
    )


def score_test(value: Array, sigma: Array, reason: str, scale: float = 1.0) -> SelfTest:
    """Test a parameter that the model holds at zero (Rao): its ``value (run,)`` if it were free.

    ``reason`` may use ``{value}``, which is in sigmas, and ``{size}``, the value times ``scale``.
    """
    return SelfTest(np.abs(value) / sigma, _SIGMAS_OF_SCORES, reason, size=scale * value)


def scores_test(scores: Array, correlation: Array) -> SelfTest:
    """Test all the scores (run, n) of a run together, each in its sigmas (Rao).

    With their ``correlation (run, n, n)`` the sum of squares is a chi-square, which sees parameters
    that are off together, each by too little for `score_test`.
    """
    from scipy.special import chdtri

    n = scores.shape[-1]
    own = solve(correlation + _ALIKE * np.eye(n), scores[..., None])[..., 0]
    return SelfTest(
        (scores * own).sum(-1) / n,
        float(chdtri(n, _CHANCE_OF_ALL)) / n,
        "what is seen goes with what the model takes for granted, all of it together: the squared "
        "scores are {value} of what noise has, at most {limit} by chance",
    )


def bend_test(rise: Array) -> SelfTest:
    """Test the rise of the cost (run,) at one sigma along the widest direction: one, if even.

    Where a valley of the cost is bent, its covariance is no ellipsoid, and normalised errors are
    far larger than the errors themselves.
    """
    return SelfTest(
        rise,
        2.0,
        "one sigma along the direction that the data tell least of, the cost rises by {value} "
        "and not by 1: the errors there are correlated in another way than stated",
    )


def gauge_test(claimed: Array) -> SelfTest:
    """Test how many times as much (run,) is claimed of what nothing measures as is known of it.

    Its own sigma can be mended, but the errors of all that turns with it lie on an arc.
    """
    return SelfTest(
        claimed,
        _CLAIMED,
        "nothing measures how the body axes are turned, and {value} times as much is claimed of it "
        "as was known at the start: attitude, rate, points and inertia err together, by one turn",
    )


def lost_test(lost: BoolArray, reason: str) -> SelfTest:
    """Return the test that runs fail which have no estimate to speak of."""
    return SelfTest(lost.astype(np.float64), 0.5, reason, Verdict.LOST)


def _mean_limit(dof: Array | IntArray) -> Array:
    """Largest square per degree of freedom, (run,): of many, ``1 + 5 sqrt(2 / dof)``."""
    from scipy.special import chdtri, ndtr

    count = np.maximum(dof, 1)
    return np.asarray(chdtri(count, ndtr(-SIGMAS)) / count)


def _relative(part: Array, whole: Array) -> Array:
    """Covariance of all in units of that of the part."""
    root = np.asarray(np.linalg.cholesky(part), dtype=np.float64)
    half = solve(root, whole)
    return np.asarray(solve(root, np.swapaxes(half, -1, -2)))
