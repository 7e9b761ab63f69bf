"""Medians and quantiles of short lists, for compiled loops: those of numpy take long to compile."""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def quantile(values: Array, share: float) -> float:
    """Return a quantile of values (n), whose order it changes.

    Between two ranks it is linear, as numpy's; that of none is NaN. None of the values may be NaN.
    """
    count = len(values)
    if count == 0:
        return np.nan
    rank = share * (count - 1)
    low = int(rank)
    least = _ranked(values, low)
    if low + 1 == count or rank == low:
        return least
    next_one = float(values[low + 1])
    for k in range(low + 2, count):
        next_one = min(next_one, float(values[k]))
    return least * (1.0 - (rank - low)) + next_one * (rank - low)


@compiled
def _ranked(values: Array, rank: int) -> float:
    """Return the value of a rank, with lower ones before it and higher behind (Hoare)."""
    first, last = 0, len(values) - 1
    while first < last:
        middle, i, j = values[(first + last) // 2], first, last
        while i <= j:
            while values[i] < middle:
                i += 1
            while values[j] > middle:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i, j = i + 1, j - 1
        first, last = (first, j) if rank <= j else ((i, last) if rank >= i else (rank, rank))
    return float(values[rank])
