"""Errors that last: what of a given variance does not show from epoch to epoch.

Where measurements scatter less about a smooth motion than their given sigma says, the rest of the
variance is either not there or lasts from epoch to epoch, as errors of calibration do; averaging
does not lower it. The data cannot tell which, so it is taken to last.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.evidence import Evidence
from debrisest.batch.path import Path

_NOISE_AS_SAID = 0.9  # of the variance


def with_lasting_errors(path: Path, evidence: Evidence, noise: float) -> Path:
    """Return the path with the variance of single epochs that ``noise``, a factor, has not shown.

    The nearest epoch that tells its attitude, or rate, lends its covariance.
    """
    share = 1.0 - noise**2
    if share < 1.0 - _NOISE_AS_SAID:
        return path
    added = share * _single(path, evidence)
    if evidence.of_rate:
        return path._replace(rate_covariance=path.rate_covariance + added)
    return path._replace(turn_covariance=path.turn_covariance + added)


def _single(path: Path, evidence: Evidence) -> Array:
    """Covariance (time, 3, 3) of the nearest epoch by itself."""
    hold = evidence.seen().information
    good = np.flatnonzero(np.linalg.eigvalsh(hold)[:, 0] > 1e-6 * np.abs(hold).max())
    after = np.minimum(np.searchsorted(evidence.times[good], path.times), len(good) - 1)
    before = np.maximum(after - 1, 0)
    gaps = [np.abs(evidence.times[good[side]] - path.times) for side in (before, after)]
    nearest = good[np.where(gaps[0] < gaps[1], before, after)]
    return np.asarray(np.linalg.inv(hold[nearest]), dtype=np.float64)
