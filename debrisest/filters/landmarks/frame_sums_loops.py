"""What frames add to the normal equations of a landmark model as plain loops.

The formulas are those of `frame_sums.sums`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.compiled import compiled

Rows = tuple[Array, Array, Array, Array, Array, Array]
"""As in `debrisest.filters.landmark_model.Rows`, of runs and frames, or of one frame."""
Seen = tuple[Array, BoolArray, Array, BoolArray]
"""As in `debrisest.filters.landmark_model.Observations`."""
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
    lines, owners = np.empty((points * each, s + 4 + causes)), np.empty(points * each, np.int64)
    for run in range(runs):
        figures = (costs[run], counts[run], landmarks[run])
        across[:] = 0.0
        for k in range(frames):
            of = (rows[0][run, k], rows[1][run, k], rows[2][run, k], rows[5][run, k])
            shown = (seen[0][run, k], seen[1][run, k])
            count = _lines(of, shown, placed[run], noise[0], limits, lines, owners, figures)
            own[:], crossed[:] = 0.0, 0.0
            _products(lines, owners, count, own, crossed, information[run], gradient[run])
            common = (rows[3][run, k], rows[4][run, k], seen[2][run, k])
            _common(common, seen[3][run, k], noise[1], limits, own, figures)
            if causes:
                _shared(lines, owners, count, shared)
                _without_shared(
                    shared, by_start[run, k], row, information[run], gradient[run], costs[run]
                )
            _by_start(by_start[run, k], own, half, crossed, across, information[run], gradient[run])
        information[run, :n_x, n_x:] += across
        information[run, n_x:, :n_x] = information[run, :n_x, n_x:].T
    return costs, information, gradient, counts, landmarks


@compiled
def _lines(
    rows: tuple[Array, Array, Array, Array],
    seen: tuple[Array, BoolArray],
    placed: BoolArray,
    sigma: Array,
    limits: tuple[float, float],
    lines: Array,
    owners: IntArray,
    figures: Figures,
) -> int:
    """Write normalised, weighted rows of what a frame has seen, and their landmarks; their number.

    Each is its derivative by s errors, the residual, the derivative by the point, its shared noise.
    """
    shown, by_core, by_point, noise = rows
    (points, each, s), count = by_core.shape, 0
    for p in range(points):
        square, used = 0.0, 0
        for i in range(each):
            if placed[p] and seen[1][p, i]:
                square += ((seen[0][p, i] - shown[p, i]) / sigma[i]) ** 2
                used += 1
        if used == 0:
            continue
        weight = _counted(square, used, limits, figures[0], figures[1])
        figures[2][0, p] += 1
        figures[2][1, p] += square < limits[1]
        for i in range(each):
            if not seen[1][p, i]:
                continue
            scale = weight / sigma[i]
            for a in range(s):
                lines[count, a] = by_core[p, i, a] * scale
            lines[count, s] = (seen[0][p, i] - shown[p, i]) * scale
            for a in range(3):
                lines[count, s + 1 + a] = by_point[p, i, a] * scale
            for a in range(noise.shape[2]):
                lines[count, s + 4 + a] = noise[p, i, a] * scale
            owners[count] = p
            count += 1
    return count


@compiled
def _counted(
    square: float, used: int, limits: tuple[float, float], costs: Array, counts: IntArray
) -> float:
    """Count components that are judged by their square together, and return their weight."""
    scale = limits[0] ** 2
    costs[0] += scale * np.log1p(square / scale) if limits[0] else square
    counts[0] += used
    if square < limits[1]:
        costs[1] += square
        counts[1] += used
    return float((1.0 + square / scale) ** -0.5 if limits[0] else 1.0)


@compiled
def _products(
    lines: Array,
    owners: IntArray,
    count: int,
    own: Array,
    crossed: Array,
    information: Array,
    gradient: Array,
) -> None:
    """Add the squares of lines: by the core (s, s + 1), with the points (s, 3 N), of the points."""
    s, first = len(own), len(gradient) - crossed.shape[1]
    for q in range(count):
        at, residual = 3 * owners[q], lines[q, s]
        x, y, z = lines[q, s + 1], lines[q, s + 2], lines[q, s + 3]
        for a in range(s):
            row = lines[q, a]
            for b in range(a, s + 1):
                own[a, b] += row * lines[q, b]
            crossed[a, at] += row * x
            crossed[a, at + 1] += row * y
            crossed[a, at + 2] += row * z
        at += first
        for a in range(3):
            row = lines[q, s + 1 + a]
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
    s = by_core.shape[1]
    for i in range(len(sigma)):
        if not seen[i]:
            continue
        residual = (measured[i] - predicted[i]) / sigma[i]
        weight = _counted(residual**2, 1, limits, figures[0], figures[1])
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
    half[:] = 0.0
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
def _shared(lines: Array, owners: IntArray, count: int, shared: tuple[Array, Array]) -> None:
    """Write the squares (c, c) of the noise that lines share, and its products with them."""
    total, right = shared
    causes = len(total)
    s, total[:], right[:] = lines.shape[1] - 4 - causes, 0.0, 0.0
    for q in range(count):
        at = s + 3 * owners[q]
        for c in range(causes):
            cause = lines[q, s + 4 + c]
            for d in range(causes):
                total[c, d] += cause * lines[q, s + 4 + d]
            for a in range(s):
                right[c, a] += cause * lines[q, a]
            for a in range(3):
                right[c, at + a] += cause * lines[q, s + 1 + a]
            right[c, -1] += cause * lines[q, s]


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
        row[:n_x], row[n_x:], seen = 0.0, right[c, s:-1], right[c, -1]
        for a in range(s):
            for b in range(n_x):
                row[b] += right[c, a] * by_start[a, b]
        for a in range(n):
            gradient[a] -= row[a] * seen
            for b in range(n):
                information[a, b] -= row[a] * row[b]
        costs[0] -= seen**2
        costs[1] -= seen**2
