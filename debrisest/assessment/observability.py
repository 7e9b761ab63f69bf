"""How many directions of a block of errors an estimator knows, and how well."""

import numpy as np

from debrisest.arrays import Array, IntArray

UNOBSERVABLE = 0.5
"""Part of the prior's 1-sigma from which nothing worth a factor of 2 was learned."""


def known_directions(covariance: Array, prior_sigma: float) -> tuple[IntArray, Array]:
    """Number of unobservable directions ``(...)`` and 1-sigma of the worst of the others.

    ``covariance (..., n, n)`` of errors whose 1-sigma was ``prior_sigma`` each before there was any
    measurement; a direction is observable where less than half of that is left. Directions are its
    principal ones, since a motion may show a combination of ratios and none of them alone. NaN
    where nothing is observable, and where the covariance is not finite, of which no direction
    counts as known.
    """
    sound = np.asarray(np.isfinite(covariance).all((-2, -1)))
    variance = np.linalg.eigvalsh(np.where(sound[..., None, None], covariance, 0.0))
    variance = np.where(sound[..., None], variance, np.inf)
    known = variance < (UNOBSERVABLE * prior_sigma) ** 2
    worst = np.where(known, np.maximum(variance, 0.0), 0.0).max(-1)
    return np.asarray((~known).sum(-1)), np.where(known.any(-1), np.sqrt(worst), np.nan)
