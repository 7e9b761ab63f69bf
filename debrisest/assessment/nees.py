"""The normalised estimation error squared at the epochs whose covariance was kept."""

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
