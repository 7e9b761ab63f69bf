"""Errors beside their covariance, at the epochs where it was kept: together, and one by one."""

import numpy as np

from debrisest.arrays import Array, Data, IntArray
from debrisest.assessment.consistency import normalized_square
from debrisest.assessment.statistics import per_dimension


def covariance_epochs(data: Data) -> IntArray:
    """Return the epochs (kept,) whose covariance was kept."""
    return np.asarray(np.searchsorted(data["time_s"], data["covariance_time_s"]))


def nees(data: Data, error: Array, covariance: Array) -> Data:
    """Return NEES per dimension (run, time), and how many dimensions it counts.

    Error ``(run, kept, n)`` and covariance ``(run, kept, n, n)`` are those of `covariance_epochs`;
    at all others, and where one of the two is not finite, NEES is NaN and counts nothing.
    """
    runs, _, n = error.shape
    square = np.full((runs, len(data["time_s"])), np.nan)
    square[:, covariance_epochs(data)] = normalized_square(error, covariance)
    dof = np.where(np.isfinite(square), float(n), 0.0)
    return {"nees": per_dimension(square, dof), "nees_dof": dof}


def deviation(data: Data, error: Array, covariance: Array) -> Data:
    """Return the largest error of a single number over its sigma (run, time), as `nees` is given.

    Where a valley of the cost bends, errors go together in another way than a covariance can say,
    and NEES is large although each number is as far off as stated. NaN where nothing is kept.
    """
    largest = np.full((len(error), len(data["time_s"])), np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        sigmas = np.abs(error) / np.sqrt(np.diagonal(covariance, 0, -2, -1))
    largest[:, covariance_epochs(data)] = sigmas.max(-1)
    return {"deviation": largest}
