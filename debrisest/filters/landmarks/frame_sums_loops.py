"""What frames add to the normal equations of a landmark model as plain loops.

The formulas are those of `frame_sums.sums`, where their words are.
"""

import numpy as np

from debrisest.array_loops import fill, fill_rows
from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.compiled import compiled

Rows = tuple[Array, Array, Array, Array, Array, Array]
"""As in `debrisest.filters.landmark_model.Rows`, of runs and frames, or of one frame."""
Seen = tuple[Array, BoolArray, Array, BoolArray]
"""As in `debrisest.filters.landmark_model.Observations`."""
Used = tuple[IntArray, IntArray, Array, Array]
"""Rows of a frame in use: landmark and component, weight over noise, weighted residual."""
Figures = tuple[Array, IntArray, IntArray]
"""Of a run: cost and squares (2), components and those near (2), landmarks seen and near (2, N)."""


@compiled
def sums(
    rows: Rows,
    seen: Seen,
    placed: BoolArray,
    noise: tuple[Array, Array],
    by_start: Array,
    limits: tuple[float, float],
) -> tuple[Array, Array, Array, IntArray, IntArray]:
    """Return cost and squares (run, 2), information, gradient, and what was counted.

    That is (run, 2) and (run, 2, N), as in `Figures`. The ``noise`` is that of a landmark's
    components and of the common ones; the ``limits`` are the scale of Cauchy's loss, 0 for none,
    and the square of what is far.
    """
    (runs, frames, s, n_x), (points, each) = by_start.shape, rows[0].shape[2:]
    n, causes = n_x + 3 * points, rows[5].shape[4]
    information, gradient, costs = np.zeros((runs, n, n)), np.zeros((runs, n)), np.zeros((runs, 2))
    counts, landmarks = np.zeros((runs, 2), np.int64), np.zeros((runs, 2, points), np.int64)
    own, crossed = np.empty((s, s + 1)), np.empty((s, 3 * points))
    half, across, row = np.empty((s, n_x)), np.empty((n_x, 3 * points)), np.empty(n)
    shared = np.empty((causes, causes)), np.empty((causes, s + 3 * points + 1))
    most = points * each
    used = np.empty(most, np.int64), np.empty(most, np.int64), np.empty(most), np.empty(most)
    for run in range(runs):
        figures = (costs[run], counts[run], landmarks[run])
        fill_rows(0.0, across)
        for k in range(frames):
            measured, shown = seen[0][run, k], rows[0][run, k]
            by_core, by_point = rows[1][run, k], rows[2][run, k]
            count = _sightings(
                shown, measured, seen[1][run, k], placed[run], noise[0], limits, used, figures
            )
            fill_rows(0.0, own)
            fill_rows(0.0, crossed)
            _products(by_core, by_point, used, count, own, crossed, information[run], gradient[run])
            common = (rows[3][run, k], rows[4][run, k], seen[2][run, k])
            _common(common, seen[3][run, k], noise[1], limits, own, figures)
            if causes:
                _shared(by_core, by_point, rows[5][run, k], used, count, shared)
                _without_shared(
                    shared, by_start[run, k], row, information[run], gradient[run], costs[run]
                )
            _by_start(by_start[run, k], own, half, crossed, across, information[run], gradient[run])
        for a in range(n_x):
            for b in range(n_x, n):
                information[run, a, b] += across[a, b - n_x]
                information[run, b, a] = information[run, a, b]
    return costs, information, gradient, counts, landmarks


@compiled
def _sightings(
    shown: Array,
    measured: Array,
    seen: BoolArray,
    placed: BoolArray,
    sigma: Array,
    limits: tuple[float, float],
    used: Used,
    figures: Figures,
) -> int:
    """Write what is used of a frame; its number of rows."""
    owners, components, scales, residuals = used
    costs, counts, landmarks = figures
    (points, each), count = shown.shape, 0
    for p in range(points):
        square, first = 0.0, count
        for i in range(each):
            if placed[p] and seen[p, i]:
                scales[count] = 1.0 / sigma[i]
                residuals[count] = (measured[p, i] - shown[p, i]) / sigma[i]
                square += residuals[count] ** 2
                owners[count], components[count] = p, i
                count += 1
        if count == first:
            continue
        loss, weight = _loss(square, limits[0])
        near = square < limits[1]
        costs[0] += loss
        costs[1] += square if near else 0.0
        counts[0] += count - first
        counts[1] += (count - first) * near
        landmarks[0, p] += 1
        landmarks[1, p] += near
        for q in range(first, count):
            scales[q] *= weight
            residuals[q] *= weight
    return count


@compiled
def _loss(square: float, scale: float) -> tuple[float, float]:
    """Return what a square costs, and the weight of its residuals; with a scale by Cauchy."""
    if scale == 0.0:
        return square, 1.0
    ratio = square / scale**2
    return scale**2 * np.log1p(ratio), 1.0 / np.sqrt(1.0 + ratio)


@compiled
def _products(
    by_core: Array,
    by_point: Array,
    used: Used,
    count: int,
    own: Array,
    crossed: Array,
    information: Array,
    gradient: Array,
) -> None:
    """Add the squares of rows: by the core (s, s + 1), with the points (s, 3 N), of the points."""
    owners, components, scales, residuals = used
    s, first = len(own), len(gradient) - crossed.shape[1]
    for q in range(count):
        p, i, scale = owners[q], components[q], scales[q]
        x, y, z = scale * by_point[p, i, 0], scale * by_point[p, i, 1], scale * by_point[p, i, 2]
        at, residual = 3 * p, residuals[q]
        for a in range(s):
            row = scale * by_core[p, i, a]
            crossed[a, at] += row * x
            crossed[a, at + 1] += row * y
            crossed[a, at + 2] += row * z
            own[a, s] += row * residual
            row *= scale
            for b in range(a, s):
                own[a, b] += row * by_core[p, i, b]
        at += first
        for a in range(3):
            row = scale * by_point[p, i, a]
            gradient[at + a] += row * residual
            information[at + a, at] += row * x
            information[at + a, at + 1] += row * y
            information[at + a, at + 2] += row * z


@compiled
def _common(
    common: tuple[Array, Array, Array],
    seen: BoolArray,
    sigma: Array,
    limits: tuple[float, float],
    own: Array,
    figures: Figures,
) -> None:
    """Add the common rows of a frame."""
    predicted, by_core, measured = common
    costs, counts, _ = figures
    s = by_core.shape[1]
    for i in range(len(sigma)):
        if not seen[i]:
            continue
        residual = (measured[i] - predicted[i]) / sigma[i]
        loss, weight = _loss(residual**2, limits[0])
        costs[0] += loss
        counts[0] += 1
        if residual**2 < limits[1]:
            costs[1] += residual**2
            counts[1] += 1
        scale, residual = weight / sigma[i], weight * residual
        for a in range(s):
            row = by_core[i, a] * scale
            own[a, s] += row * residual
            for b in range(a, s):
                own[a, b] += row * (by_core[i, b] * scale)


@compiled
def _by_start(
    by_start: Array,
    own: Array,
    half: Array,
    crossed: Array,
    across: Array,
    information: Array,
    gradient: Array,
) -> None:
    """Add a frame's sums by its own core as those by the start's parameters."""
    s, n_x = by_start.shape
    fill_rows(0.0, half)
    for a in range(s):
        for b in range(s):
            x = own[min(a, b), max(a, b)]
            for c in range(n_x):
                half[a, c] += x * by_start[b, c]
    for a in range(s):
        for b in range(n_x):
            x = by_start[a, b]
            if x == 0.0:
                continue
            gradient[b] += x * own[a, s]
            for c in range(n_x):
                information[b, c] += x * half[a, c]
            for c in range(crossed.shape[1]):
                across[b, c] += x * crossed[a, c]


@compiled
def _shared(
    by_core: Array,
    by_point: Array,
    noise: Array,
    used: Used,
    count: int,
    shared: tuple[Array, Array],
) -> None:
    """Write the squares (c, c) of the noise that rows share, and its products with them."""
    total, right = shared
    fill_rows(0.0, total)
    fill_rows(0.0, right)
    s = by_core.shape[2]
    for q in range(count):
        p, i, scale = used[0][q], used[1][q], used[2][q]
        for c in range(len(total)):
            cause = scale * scale * noise[p, i, c]
            for d in range(len(total)):
                total[c, d] += cause * noise[p, i, d]
            for a in range(s):
                right[c, a] += cause * by_core[p, i, a]
            for a in range(3):
                right[c, s + 3 * p + a] += cause * by_point[p, i, a]
            right[c, -1] += scale * noise[p, i, c] * used[3][q]


@compiled
def _without_shared(
    causes: tuple[Array, Array],
    by_start: Array,
    row: Array,
    information: Array,
    gradient: Array,
    costs: Array,
) -> None:
    """Take out what noise that all landmarks of a frame share makes uncertain."""
    shared, right = causes
    (s, n_x), n = by_start.shape, len(row)
    for c in range(len(shared)):
        for d in range(c + 1):
            left = shared[c, d] + (c == d)
            for e in range(d):
                left -= shared[c, e] * shared[d, e]
            shared[c, d] = np.sqrt(left) if c == d else left / shared[d, d]
        for a in range(right.shape[1]):
            for d in range(c):
                right[c, a] -= shared[c, d] * right[d, a]
            right[c, a] /= shared[c, c]
        fill(0.0, row)
        seen = right[c, -1]
        for a in range(n_x, n):
            row[a] = right[c, s + a - n_x]
        for a in range(s):
            for b in range(n_x):
                row[b] += right[c, a] * by_start[a, b]
        for a in range(n):
            gradient[a] -= row[a] * seen
            for b in range(n):
                information[a, b] -= row[a] * row[b]
        costs[0] -= seen**2
        costs[1] -= seen**2
