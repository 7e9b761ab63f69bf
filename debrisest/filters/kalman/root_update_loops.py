"""Update of a triangular root of a covariance as plain loops, for `debrisest.compiled`.

A covariance is the sum of the outer products of columns, each of which is a row ``(n,)`` of an
array here: ``columns (n, n)`` are a lower triangular root, transposed. It is never formed, nor
factored.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.linear_algebra_loops import add_products, cholesky

_BLOCK = 16  # columns that are updated together


@compiled
def correct(
    columns: Array, odd: Array, noise: Array, innovation: Array
) -> tuple[Array, Array, Array]:
    """Update columns ``(run, n, n)``; return correction and variance (run, n), and NIS (run,).

    ``odd (run, n, m)`` is what the measurement changes by along each column, ``noise (run, m, m)``
    the covariance of what else is in it; a NaN of the innovation (run, m) was not observed. Such
    columns L and rows F become L B, where B B^T = (I + F noise^-1 F^T)^-1: from the last block of
    columns to the first, each by the information of those behind it.
    """
    runs, n, m = odd.shape
    correction, variance, nis = np.zeros((runs, n)), np.zeros((runs, n)), np.zeros(runs)
    total, gain, turned = np.empty((m, m)), np.empty((m, n)), np.empty((m, n))
    factors, halves = (
        (np.empty((m, m)), np.empty((m, m))),
        (np.empty((m, _BLOCK)), np.empty((_BLOCK, m))),
    )
    inner = np.empty((_BLOCK, _BLOCK)), np.empty((_BLOCK, _BLOCK))
    updated = np.empty((_BLOCK, n))
    for run in range(runs):
        _leave_out(innovation[run], odd[run], noise[run])
        made, along = columns[run], odd[run]
        for q in range(m):
            for p in range(m):
                total[q, p] = noise[run, q, p]
            for j in range(n):
                gain[q, j], turned[q, j] = 0.0, along[j, q]
        for end in range(n, 0, -_BLOCK):
            first = max(end - _BLOCK, 0)
            cholesky(total, *factors)
            _solve_block(along, first, end, factors, halves, inner)
            _correct_block(made, gain, halves[1], inner[1], first, end, updated)
            for q in range(m):
                add_products(gain, q, made, turned, q, first, end, first, 1.0)
                add_products(total, q, along, turned, q, first, end, q, 1.0)
            for c in range(first, end):
                for r in range(np.uint64(first), np.uint64(n)):
                    made[c, r] = updated[c - first, r]
        cholesky(total, *factors)
        nis[run] = _solve(factors, innovation, run)
        add_products(correction, run, gain, innovation, run, 0, m, 0, 1.0)
        for c in range(n):
            for r in range(np.uint64(c), np.uint64(n)):
                variance[run, r] += made[c, r] * made[c, r]
    return correction, variance, nis


@compiled
def _leave_out(innovation: Array, odd: Array, noise: Array) -> None:
    for q in range(len(innovation)):
        if np.isnan(innovation[q]):
            for j in range(len(odd)):
                odd[j, q] = 0.0
            for p in range(len(noise)):
                noise[q, p] = noise[p, q] = 0.0
            innovation[q], noise[q, q] = 0.0, 1.0


@compiled
def _solve_block(
    along: Array,
    first: int,
    end: int,
    factors: tuple[Array, Array],
    halves: tuple[Array, Array],
    inner: tuple[Array, Array],
) -> None:
    """Write total^-1 F (b, m) of some columns, and the root Z, ``Z^T Z = I + F^T total^-1 F``."""
    upper, lower = factors
    half, turned = halves
    m = len(upper)
    for q in range(m):
        for c in range(_BLOCK):
            half[q, c] = along[first + c, q] if first + c < end else 0.0
        add_products(half, q, half, lower, q, 0, q, 0, -1.0)
        scale = 1.0 / upper[q, q]
        for c in range(_BLOCK):
            half[q, c] *= scale
            turned[c, q] = half[q, c]
    root, across = inner
    for k in range(_BLOCK - 1, -1, -1):
        for c in range(_BLOCK):
            root[k, c] = 1.0 if c == k else 0.0
        add_products(root, k, half, turned, k, 0, m, 0, 1.0)
        add_products(root, k, root, across, k, k + 1, _BLOCK, 0, -1.0)
        scale = 1.0 / np.sqrt(root[k, k])
        for c in range(_BLOCK):
            root[k, c] *= scale
            across[c, k] = root[k, c]
    for q in range(m - 1, -1, -1):
        add_products(half, q, half, upper, q, q + 1, m, 0, -1.0)
        scale = 1.0 / upper[q, q]
        for c in range(_BLOCK):
            half[q, c] *= scale
            turned[c, q] = half[q, c]


@compiled
def _correct_block(
    columns: Array, gain: Array, solved: Array, inner: Array, first: int, end: int, updated: Array
) -> None:
    """Write the updated columns, without what they tell themselves of the others."""
    n, m = len(columns), len(gain)
    for c in range(end - first - 1, -1, -1):
        for r in range(np.uint64(first), np.uint64(n)):
            updated[c, r] = columns[first + c, r]
        add_products(updated, c, gain, solved, c, 0, m, end, -1.0)
        add_products(updated, c, updated, inner, c, c + 1, end - first, first, -1.0)
        scale = 1.0 / inner[c, c]
        for r in range(np.uint64(first), np.uint64(n)):
            updated[c, r] *= scale


@compiled
def _solve(factors: tuple[Array, Array], right: Array, run: int) -> float:
    """Replace a row of the right side by its solution; return its square, weighed by the matrix."""
    upper, lower = factors
    square, m = 0.0, len(upper)
    for q in range(m):
        for p in range(q):
            right[run, q] -= lower[q, p] * right[run, p]
        right[run, q] /= upper[q, q]
        square += right[run, q] ** 2
    for q in range(m - 1, -1, -1):
        for p in range(q + 1, m):
            right[run, q] -= upper[q, p] * right[run, p]
        right[run, q] /= upper[q, q]
    return square
