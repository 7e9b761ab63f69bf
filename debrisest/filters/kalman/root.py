"""Updates of a triangular root of a covariance.

A covariance is the sum of the outer products of columns, each of which is a row of an array here:
``columns (run, n, n)`` are a lower triangular root, transposed.
"""

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.filters.linear_algebra import solve, square_root
from debrisest.filters.missing import drop_missing


def columns_of(covariance: Array) -> tuple[Array, IntArray]:
    """Return columns, and whether a covariance (run, n, n) had to be repaired to have some."""
    root, repaired = square_root(covariance)
    return np.ascontiguousarray(np.swapaxes(root, -2, -1)), repaired.astype(np.int64)


def fold(columns: Array, loose: Array, own: int) -> IntArray:
    """Make columns triangular, which are so from number ``own`` on; count repairs (run,).

    The first ones are made of the first of the loose ones ``(run, c, n)``, and what these leave
    goes into all the others.
    """
    if compiled.available():
        from debrisest.filters.kalman.root_prediction_loops import fold as fold_compiled

        fold_compiled(columns, loose, own)
        return np.zeros(len(columns), dtype=np.int64)
    covariance = gram(loose)
    covariance[:, own:, own:] += gram(columns[:, own:, own:])
    columns[:], repaired = columns_of(covariance)
    return repaired


def correct(
    columns: Array, odd: Array, noise: Array, innovation: Array
) -> tuple[Array, Array, Array, IntArray]:
    """Update columns by a measurement.

    ``odd (run, n, m)`` is what it changes by along each column, ``noise (run, m, m)`` the
    covariance of what else is in it; a NaN of the innovation (run, m) was not observed. Returns
    correction and variance (run, n), NIS and repairs (run,).
    """
    if compiled.available():
        from debrisest.filters.kalman.root_update_loops import correct as correct_compiled

        found = correct_compiled(columns, odd, noise, innovation)
        return *found, np.zeros(len(columns), dtype=np.int64)
    innovation, odd, noise = drop_missing(~np.isnan(innovation), innovation, odd, noise)
    back = np.swapaxes(odd, -2, -1)
    right = np.concatenate([back @ columns, innovation[..., None]], axis=-1)
    solved = solve(back @ odd + noise, right)
    gain = solved[..., :-1]
    covariance = gram(columns - odd @ gain) + np.swapaxes(gain, -2, -1) @ (noise @ gain)
    variance = np.copy(np.diagonal(covariance, 0, -2, -1))
    nis = (innovation * solved[..., -1]).sum(-1)
    columns[:], repaired = columns_of(covariance)
    return (innovation[:, None] @ gain)[:, 0], variance, nis, repaired


def gram(a: Array) -> Array:
    """Sum of the outer products of rows ``(run, c, n)``, symmetric to the last bit."""
    return np.swapaxes(a, -2, -1) @ a
