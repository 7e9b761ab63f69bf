"""Gauss-Newton steps of the update by a frame as plain loops.

The formulas are those of `update`, where their words are. Rows that are not used are left out, and
a step needs no gain: with the factor L of the innovations' covariance ``S = L L^T``, the whitened
``V = L^-1 H P`` and ``z = L^-1 nu``, the correction is ``V^T z`` and the covariance ``P - V^T V``.
"""

import numpy as np

from debrisest.array_loops import fill, fill_rows
from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.compiled import compiled

Rows = tuple[Array, Array, Array, Array, Array, Array]
"""As in `debrisest.filters.landmark_model.Rows`, of runs and one frame."""
Lines = tuple[Array, IntArray, IntArray]
"""Rows in use: derivatives by s errors and by a point, and shared noise (m, s + 3 + c); where in
the errors their point begins, or -1, and which components they are (m)."""


@compiled
def step(
    runs: IntArray,
    rows: Rows,
    shown: Array,
    common: Array,
    covariance: Array,
    shown_by: IntArray,
    sigma: Array,
    inflation: float,
    tolerance: float,
    limits: Array,
    used: BoolArray,
    whitened: Array,
    correction: Array,
) -> tuple[BoolArray, Array]:
    """Take a step of some runs, from their ``correction (run, n_e)``, which is changed in place.

    What was measured is ``shown (run, N, r)`` and ``common (run, m)``;
    ``covariance (run, n_e, n_e)`` and corrections are of the prior, ``sigma (m,)`` is that of all
    components. The first step has ``limits`` of the gate by the number of a landmark's components,
    and takes what is rejected out of ``used (run, m)``. Writes ``whitened (run, m, n_e)``, zero
    beyond what is used; returns which runs have moved beyond a part of their sigma, the
    ``tolerance``, and the squares of their whitened innovations, (run,) each.
    """
    n, m, s, causes = covariance.shape[1], len(sigma), len(shown_by), rows[5].shape[4]
    moved, squares = np.zeros(len(used), np.bool_), np.zeros(len(used))
    derivative, owners = np.empty((m, s + 3 + causes)), np.empty(m, np.int64)
    components, tableau = np.empty_like(owners), np.empty((m, n + m + 1))
    lines = (derivative, owners, components)
    left, new = np.empty(n), np.empty(n)
    for run in runs:
        count = _lines(rows, (shown, common), run, used[run], lines, tableau)
        _spread(derivative, owners, count, covariance[run], shown_by, tableau)
        _total(derivative, owners, components, count, shown_by, sigma, inflation, n, tableau)
        if len(limits):
            count = _gated(owners, components, count, n, limits, used[run], tableau)
        else:
            _relative(derivative, owners, count, shown_by, correction[run], tableau)
        _whiten(tableau, count, n)
        fill_rows(0.0, whitened[run, count:])
        for q in range(count):
            squares[run] += tableau[q, -1] ** 2
            for a in range(n):
                whitened[run, q, a] = tableau[q, a]
        _sums(tableau, count, left, new)
        for a in range(n):
            variance = covariance[run, a, a]
            size = max(variance - left[a], 1e-12 * abs(variance))
            moved[run] |= abs(new[a] - correction[run, a]) > tolerance * np.sqrt(size)
            correction[run, a] = new[a]
        moved[run] &= count > 0
    return moved, squares


@compiled
def _lines(
    rows: Rows,
    measured: tuple[Array, Array],
    run: int,
    used: BoolArray,
    lines: Lines,
    tableau: Array,
) -> int:
    """Write the rows of a run that are used, and their innovations; their number."""
    derivative, owners, components = lines
    pixels, ranges = measured
    shown, by_core, by_point, common, common_by_core, noise = rows
    (points, each, s), n, count = by_core.shape[2:], tableau.shape[1] - 1 - len(used), 0
    for p in range(points):
        for i in range(each):
            if used[p * each + i]:
                for a in range(s):
                    derivative[count, a] = by_core[run, 0, p, i, a]
                for a in range(3):
                    derivative[count, s + a] = by_point[run, 0, p, i, a]
                for a in range(noise.shape[4]):
                    derivative[count, s + 3 + a] = noise[run, 0, p, i, a]
                owners[count], components[count] = n - 3 * (points - p), p * each + i
                tableau[count, -1] = pixels[run, p, i] - shown[run, 0, p, i]
                count += 1
    for i in range(common.shape[2]):
        if used[points * each + i]:
            fill(0.0, derivative[count])
            for a in range(s):
                derivative[count, a] = common_by_core[run, 0, i, a]
            owners[count], components[count] = -1, points * each + i
            tableau[count, -1] = ranges[run, i] - common[run, 0, i]
            count += 1
    return count


@compiled
def _spread(
    derivative: Array,
    owners: IntArray,
    count: int,
    covariance: Array,
    shown_by: IntArray,
    tableau: Array,
) -> None:
    """Write ``H P (count, n_e)``, three errors at a time."""
    n, s = len(covariance), len(shown_by)
    for q in range(count):
        fill(0.0, tableau[q, :n])
        for a in range(0, s - 2, 3):
            x, y, z = derivative[q, a], derivative[q, a + 1], derivative[q, a + 2]
            i, j, k = shown_by[a], shown_by[a + 1], shown_by[a + 2]
            for b in range(n):
                tableau[q, b] += x * covariance[i, b] + y * covariance[j, b] + z * covariance[k, b]
        for a in range(s - s % 3, s):
            for b in range(n):
                tableau[q, b] += derivative[q, a] * covariance[shown_by[a], b]
        if owners[q] >= 0:
            x, y, z = derivative[q, s], derivative[q, s + 1], derivative[q, s + 2]
            i, j, k = owners[q], owners[q] + 1, owners[q] + 2
            for b in range(n):
                tableau[q, b] += x * covariance[i, b] + y * covariance[j, b] + z * covariance[k, b]


@compiled
def _total(
    derivative: Array,
    owners: IntArray,
    components: IntArray,
    count: int,
    shown_by: IntArray,
    sigma: Array,
    inflation: float,
    n: int,
    tableau: Array,
) -> None:
    """Write the upper triangle of the innovations' covariance."""
    s = len(shown_by)
    for q in range(count):
        fill(0.0, tableau[q, n : n + q])
        for r in range(q, count):
            value, owner = 0.0, owners[r]
            for a in range(s):
                value += derivative[r, a] * tableau[q, shown_by[a]]
            if owner >= 0:
                value += derivative[r, s] * tableau[q, owner]
                value += derivative[r, s + 1] * tableau[q, owner + 1]
                value += derivative[r, s + 2] * tableau[q, owner + 2]
            for a in range(s + 3, derivative.shape[1]):
                value += inflation * derivative[q, a] * derivative[r, a]
            tableau[q, n + r] = value
        tableau[q, n + q] += inflation * sigma[components[q]] ** 2


@compiled
def _gated(
    owners: IntArray,
    components: IntArray,
    count: int,
    n: int,
    limits: Array,
    used: BoolArray,
    tableau: Array,
) -> int:
    """Leave out landmarks and common rows that are too far from their prediction; what is left."""
    first, kept, place = 0, 0, np.empty(count, np.int64)
    block = np.empty((len(limits), len(limits)))
    while first < count:
        last = first + 1
        while last < count and owners[last] == owners[first] and owners[first] >= 0:
            last += 1
        near = _square(tableau, n, first, last, block) <= limits[last - first]
        for q in range(first, last):
            used[components[q]] = near
            if near:
                place[kept] = q
                kept += 1
        first = last
    if kept < count:
        for i in range(kept):
            q = place[i]
            tableau[i, -1] = tableau[q, -1]
            for a in range(n):
                tableau[i, a] = tableau[q, a]
            for j in range(i, kept):
                tableau[i, n + j] = tableau[q, n + place[j]]
    return kept


@compiled
def _square(tableau: Array, n: int, first: int, last: int, block: Array) -> float:
    """Square of a few innovations by their covariance."""
    square, size = 0.0, last - first
    for q in range(size):
        for e in range(q + 1, size):
            block[q, e] = tableau[first + q, n + first + e]
        diagonal, left = tableau[first + q, n + first + q], tableau[first + q, -1]
        for r in range(q):
            diagonal -= block[r, q] ** 2
            left -= block[r, q] * block[r, r]
            for e in range(q + 1, size):
                block[q, e] -= block[r, q] * block[r, e]
        root = np.sqrt(diagonal)
        for e in range(q + 1, size):
            block[q, e] /= root
        block[q, q] = left / root
        square += block[q, q] ** 2
    return square


@compiled
def _relative(
    derivative: Array,
    owners: IntArray,
    count: int,
    shown_by: IntArray,
    correction: Array,
    tableau: Array,
) -> None:
    """Add to innovations what the correction so far has taken from those of the prior."""
    s = len(shown_by)
    for q in range(count):
        for a in range(s):
            tableau[q, -1] += derivative[q, a] * correction[shown_by[a]]
        if owners[q] >= 0:
            for a in range(3):
                tableau[q, -1] += derivative[q, s + a] * correction[owners[q] + a]


@compiled
def _whiten(tableau: Array, count: int, n: int) -> None:
    """Replace ``H P``, S and the innovations ``(m, n_e + m + 1)`` by V, ``L^T`` and z."""
    wide = tableau.shape[1]
    for q in range(count):
        at = n + q
        for r in range(0, q - 3, 4):
            a, b, c, d = tableau[r, at], tableau[r + 1, at], tableau[r + 2, at], tableau[r + 3, at]
            for e in range(wide):
                tableau[q, e] -= (a * tableau[r, e] + b * tableau[r + 1, e]) + (
                    c * tableau[r + 2, e] + d * tableau[r + 3, e]
                )
        for r in range(q - q % 4, q):
            a = tableau[r, at]
            for e in range(wide):
                tableau[q, e] -= a * tableau[r, e]
        scale = 1.0 / np.sqrt(tableau[q, at])
        for e in range(wide):
            tableau[q, e] *= scale


@compiled
def _sums(tableau: Array, count: int, left: Array, new: Array) -> None:
    """Write by how much variances (n_e) shrink, and the correction (n_e)."""
    fill(0.0, left)
    fill(0.0, new)
    for q in range(count):
        innovation = tableau[q, -1]
        for a in range(len(new)):
            left[a] += tableau[q, a] ** 2
            new[a] += tableau[q, a] * innovation


@compiled
def contracted(covariance: Array, whitened: Array) -> Array:
    """Return covariances (run, n_e, n_e) less the squares of ``whitened (run, m, n_e)``."""
    result = covariance.copy()
    for run in range(len(result)):
        _less_squares(result[run], whitened[run])
    return result


@compiled
def _less_squares(new: Array, rows: Array) -> None:
    """Take squares of rows (m, n), eight at a time, from a symmetric matrix."""
    m, n = rows.shape
    for q in range(0, m - 7, 8):
        for a in range(n):
            c, d, e, f = rows[q, a], rows[q + 1, a], rows[q + 2, a], rows[q + 3, a]
            g, h, i, j = rows[q + 4, a], rows[q + 5, a], rows[q + 6, a], rows[q + 7, a]
            for b in range(n):
                new[a, b] -= (
                    (c * rows[q, b] + d * rows[q + 1, b])
                    + (e * rows[q + 2, b] + f * rows[q + 3, b])
                ) + (
                    (g * rows[q + 4, b] + h * rows[q + 5, b])
                    + (i * rows[q + 6, b] + j * rows[q + 7, b])
                )
    for q in range(m - m % 8, m):
        for a in range(n):
            for b in range(n):
                new[a, b] -= rows[q, a] * rows[q, b]
