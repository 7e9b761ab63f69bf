"""Information carried from one epoch's chart to another's as plain loops.

Matrices are those of `chart` and of `replay.transition`, where their words are.
"""

import numpy as np

from debrisest.array_loops import copy_rows, fill_rows
from debrisest.arrays import Array
from debrisest.attitude.vector_loops import vector
from debrisest.compiled import compiled
from debrisest.problems.stereo_pose.chart_loops import by_own, by_plain, place


@compiled
def carried(
    before: Array, after: Array, information: Array, turning: Array, back: Array, plain: bool
) -> Array:
    """Return information (run, n_e, n_e) in the charts of states (run, n) of a later epoch.

    What is given is ``plain``, or in the charts of those before.
    ``turning (run, 6, 8)`` as of `chart.propagate`; ``back (6, 6)`` takes the centre's errors back.
    """
    n_e, points = information.shape[1], (before.shape[1] - 15) // 3
    result, matrix, unturned = np.empty(information.shape), np.empty((n_e, n_e)), np.empty((6, 14))
    turn, arms, between = np.empty((3, 3)), np.empty((points + 1, 3)), np.empty((6, n_e))
    for run in range(len(before)):
        turned_back(turning[run], unturned)
        copy_rows(information[run], matrix)
        for _ in range(2):
            if not plain:
                place(before[run], turn, arms)
                by_plain(vector(before[run, 6:]), turn, arms, matrix, between)
            moved_back(unturned, back, matrix, between)
            place(after[run], turn, arms)
            by_own(vector(after[run, 6:]), turn, arms, matrix, between)
            for a in range(n_e):
                for b in range(n_e):
                    result[run, b, a] = matrix[a, b]
            copy_rows(result[run], matrix)
    return result


@compiled
def turned_back(turning: Array, result: Array) -> None:
    """Write the inverse of the first six columns (6, 8) into the last eight (6, 14).

    The last two of these are what the ratios take off.
    """
    fill_rows(0.0, result)
    for a in range(6):
        for b in range(6):
            result[a, b] = turning[a, b]
        result[a, 6 + a], result[a, 12], result[a, 13] = 1.0, -turning[a, 6], -turning[a, 7]
    for k in range(6):
        largest = k
        for a in range(k + 1, 6):
            largest = a if abs(result[a, k]) > abs(result[largest, k]) else largest
        for b in range(k, 14):
            result[k, b], result[largest, b] = result[largest, b], result[k, b]
        own = 1.0 / result[k, k]
        for b in range(k, 14):
            result[k, b] *= own
        for a in range(6):
            share = result[a, k] if a != k else 0.0
            for b in range(k, 14):
                result[a, b] -= share * result[k, b]


@compiled
def moved_back(unturned: Array, back: Array, matrix: Array, between: Array) -> None:
    """Multiply the rows of a matrix (n_e, n_e) by a transposed inverse transition, in place."""
    for first in range(0, 12, 6):
        of, start = (back, 0) if first == 0 else (unturned, 6)
        copy_rows(matrix[first : first + 6], between)
        for a in range(6 if first == 0 else 8):
            p, q, r = of[0, start + a], of[1, start + a], of[2, start + a]
            x, y, z = of[3, start + a], of[4, start + a], of[5, start + a]
            kept = 0.0 if a < 6 else 1.0
            for b in range(matrix.shape[1]):
                three = p * between[0, b] + q * between[1, b] + r * between[2, b]
                three += x * between[3, b] + y * between[4, b] + z * between[5, b]
                matrix[first + a, b] = kept * matrix[first + a, b] + three
