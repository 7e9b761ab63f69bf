"""Medians of rows that are not full."""

import numpy as np

from debrisest.arrays import Array


def row_median(values: Array) -> Array:
    """Return the median (row,) of each row (row, n), of which some are NaN, but not all."""
    ordered, count = np.sort(values, axis=-1), np.isfinite(values).sum(axis=-1)
    rows = np.arange(len(values))
    return np.asarray(0.5 * (ordered[rows, (count - 1) // 2] + ordered[rows, count // 2]))
