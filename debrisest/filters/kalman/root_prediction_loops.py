"""A triangular root of a predicted covariance as plain loops, for `debrisest.compiled`.

A covariance is the sum of the outer products of columns, each of which is a row ``(n,)`` of an
array here: ``columns (n, n)`` are a lower triangular root, transposed. It is never formed, nor
factored.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.linear_algebra_loops import add_products


@compiled
def fold(columns: Array, loose: Array, own: int) -> None:
    """Make columns triangular, for each of a batch of runs (Householder).

    ``columns (run, n, n)`` are so from number ``own`` on. The first ones are made of the first of
    the loose ones ``(run, c, n)``, and what these leave goes into all the others.
    """
    n, count = columns.shape[2], loose.shape[1]
    sums, shares = np.empty((1, n)), np.empty((1, count))
    for run in range(len(columns)):
        made, left = columns[run], loose[run]
        for i in range(n):
            if i < own:
                made[i, :i] = 0.0
                for r in range(i, n):
                    made[i, r] = left[i, r]
            reflect(made, left, i, min(i + 1, own), sums, shares)


@compiled
def reflect(columns: Array, loose: Array, i: int, first: int, sums: Array, shares: Array) -> None:
    """Turn column i and the loose ones from the first on, so that these lose component i."""
    rest, head, count = 0.0, columns[i, i], len(loose)
    for c in range(first, count):
        shares[0, c] = loose[c, i]
        rest += shares[0, c] ** 2
    if rest == 0.0:
        return
    length = -np.copysign(np.sqrt(head * head + rest), head)
    head -= length
    scale = 1.0 / (length * head)
    for r in range(np.uint64(i), np.uint64(columns.shape[1])):
        sums[0, r] = head * scale * columns[i, r]
    for c in range(first, count):
        shares[0, c] *= scale
    add_products(sums, 0, loose, shares, 0, first, count, i, 1.0)
    for r in range(np.uint64(i), np.uint64(columns.shape[1])):
        columns[i, r] += head * sums[0, r]
    for c in range(first, count):
        share = shares[0, c] / scale
        for r in range(np.uint64(i), np.uint64(columns.shape[1])):
            loose[c, r] += share * sums[0, r]
