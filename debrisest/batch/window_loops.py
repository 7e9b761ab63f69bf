"""The fit of a window on known points, cleaned of outliers, and its tests, as plain loops.

The steps are those of `windows` and `acceptance`, where their words are.
"""

import numpy as np

from debrisest.array_loops import differ
from debrisest.arrays import Array
from debrisest.attitude.rotation_loops import Vector, rows_of
from debrisest.batch.arc_loops import Arcs, diagonalised, matrix_of, motion
from debrisest.batch.descent_loops import Settings, descent, epochs_of, room_of
from debrisest.batch.known_points_loops import Points, Sums, gated, squares, sums
from debrisest.batch.normal_loops import at, said
from debrisest.compiled import compiled
from debrisest.order_loops import quantile

Gates = tuple[float, int, float, float, float]
"""Limit, rounds, share of squares that are tame, how many times these are wild, and the median
above which the limit grows."""
_TOLD = 1e-10  # of the best direction's information


@compiled
def fitted(
    times: Array,
    points: Points,
    weight: Array,
    arc: Arcs,
    held: tuple[Array, Array],
    settings: Settings,
    iterations: int,
    gates: Gates,
) -> tuple[float, bool, Array, Array]:
    """Move an arc to where it fits best; return chi-square, whether it has settled, and more.

    The rest are its information (11, 11) and the weights (time, feature) without outliers. Times
    count from the arc's epoch.
    """
    gate, rounds, _, _, _ = gates
    place, hold = room_of(len(times)), np.zeros((11, 11))
    q, square, kept, dof = place[0][0], np.empty(weight.shape), weight, times
    chi2, settled = np.inf, False
    for turn in range(rounds + 1):
        motion(times, arc[0], arc[1], matrix_of(arc[2]), q, place[1])
        squares(points, weight, q, square)
        limit = _limit(square, gates, turn == 0)
        trial = gated(points, weight, q, square, limit)
        told = sums(points, trial)
        if turn > 0 and limit == gate and differ(told[3], dof) == 0:
            break
        kept, dof, epochs = trial, told[3], epochs_of(times, told)
        chi2, settled = descent(epochs, arc, held, iterations, settings, place, hold)
    return chi2, settled, hold, kept


@compiled
def _limit(square: Array, gates: Gates, first: bool) -> float:
    """Limit of squares: of a prediction by how it fits, else wider where outliers have drawn it."""
    gate, _, tame, share, usual = gates
    seen, count, finite, below, largest = np.empty(square.size), 0, 0, 0, 0.0
    for row in range(len(square)):
        for value in square[row]:
            if not np.isnan(value):
                seen[count] = value
                count += 1
                finite += np.isfinite(value)
                below += value <= usual
                largest = max(largest, value)
    if first:
        return gate + share * quantile(seen[:count], tame) if largest > gate else gate
    return gate if 2 * below > finite else gate * max(1.0, quantile(seen[:count], 0.5) / usual)


@compiled
def offsets(clock: Array, q: Array, sums: Sums, most: int) -> tuple[float, Array, Array, float]:
    """Return chi-square, that of the blocks' mean offsets (2, block), limits, s, and all dof.

    Of attitudes ``q (4, time)``. Offsets in inertial axes, then in those of the body; at most so
    many blocks.
    """
    product, hold, squared, dof = sums
    count, whole = min(most, max(len(clock) // 3, 1)), 0.0
    for told in dof:
        whole += told
    pull, information = np.zeros((2, count, 3)), np.zeros((2, count, 3, 3))
    chi2, share, ends, last = 0.0, 0.0, np.full(count + 1, clock[-1]), -1
    for t in range(len(clock)):
        share += dof[t]
        block = min(int(share / max(whole, 1.0) * count * (1.0 - 1e-12)), count - 1)
        for k in range(last + 1, block + 1):
            ends[k] = clock[t]
        last = max(last, block)
        rows = rows_of(at(q, t))
        fit, pulled, upper = said((product, hold), rows, t)
        chi2 += squared[t] - 2.0 * fit
        for i in range(3):
            pull[0, block, i] += pulled[i]
            for j in range(3):
                pull[1, block, i] += rows[j][i] * pulled[j]
        _added(information[0, block], upper)
        own = (hold[0, t], hold[1, t], hold[2, t]), (hold[3, t], hold[4, t], hold[5, t])
        _added(information[1, block], own)
    values = np.empty((2, last + 1))
    for k in range(last + 1):
        for n in range(2):
            values[n, k] = _quadratic(information[n, k], pull[n, k])
    return chi2, values, ends, whole


@compiled
def _added(total: Array, upper: tuple[Vector, Vector]) -> None:
    """Add a symmetric matrix, given by its upper triangle row by row."""
    (a, b, c), (d, e, f) = upper
    for i, row in enumerate(((a, b, c), (b, d, e), (c, e, f))):
        for j in range(3):
            total[i, j] += row[j]


@compiled
def _quadratic(matrix: Array, vector: Array) -> float:
    """``v^T A^-1 v`` over the directions that a symmetric matrix tells."""
    scale, total = max(matrix[0, 0], matrix[1, 1], matrix[2, 2]), 0.0
    if not scale > 0.0:
        return total
    values = matrix / scale
    rows = rows_of(diagonalised(values, 1e-18))
    largest = max(values[0, 0], values[1, 1], values[2, 2])
    for k in range(3):
        if values[k, k] > _TOLD * largest:
            part = rows[0][k] * vector[0] + rows[1][k] * vector[1] + rows[2][k] * vector[2]
            total += part * part / (values[k, k] * scale)
    return total
