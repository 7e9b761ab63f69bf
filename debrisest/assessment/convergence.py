"""When an error has become small for good."""

import numpy as np

from debrisest.arrays import Array


def convergence_time(limit: float, error: Array, times: Array) -> Array:
    """Return the first time (...) from which ``error`` (..., time) stays at or below ``limit``.

    Where it never does, the end of the time span (an error that is not finite counts as above).
    """
    above = ~(np.abs(error) <= limit)
    settled = np.where(above, np.arange(1, len(times) + 1), 0).max(axis=-1)
    settling: Array = np.append(times, 2 * times[-1] - times[-2])[settled]
    return settling
