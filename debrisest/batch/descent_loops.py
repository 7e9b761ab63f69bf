"""The descents of `descent` on known points as plain loops, for `debrisest.compiled`."""

import numpy as np

from debrisest.array_loops import copy, copy_rows, dot
from debrisest.arrays import Array
from debrisest.batch.arc_loops import Arcs, displaced, matrix_of, motion
from debrisest.batch.known_points_loops import Sums
from debrisest.batch.normal_loops import Work, fit, normal, room
from debrisest.compiled import compiled
from debrisest.linear_algebra_loops import solve

Settings = tuple[float, float, float, float, float, float]
"""Least gain, sigma of the wide prior, widest log-ratios, least damping, most, turn of a step."""
Epochs = tuple[Array, Array, Array, float, float]
"""Times since the epoch, two sums of known points, all squares, and the longest time."""
Room = tuple[Array, Array, Work]
"""For attitudes (9, 4, time) and rates (3, time) of an arc and eight beside it, and for a block."""


@compiled
def room_of(times: int) -> Room:
    """Return room for so many epochs."""
    return np.empty((9, 4, times)), np.empty((3, times)), room()


@compiled
def epochs_of(times: Array, sums: Sums) -> Epochs:
    """Return what a descent takes of sums of points; times count from the arc's epoch."""
    longest = 0.0
    for time in times:
        longest = max(longest, abs(time))
    return times, sums[0], sums[1], np.sum(sums[2]), longest


@compiled
def costs(times: Array, sums: Sums, arcs: Arcs, settings: Settings) -> Array:
    """Return chi-squares (arc,) with the wide prior, infinite where no body is looked for."""
    _, wide, widest, _, _, _ = settings
    result, squares = np.full(len(arcs[0]), np.inf), np.sum(sums[2])
    q, rates = np.empty((4, len(times))), np.empty((3, len(times)))
    for n in range(len(result)):
        far2 = dot(arcs[2][n], arcs[2][n])
        if np.sqrt(far2) < widest:
            motion(times, arcs[0][n], arcs[1][n], matrix_of(arcs[2][n]), q, rates)
            cost = squares - 2.0 * fit(q, sums[0]) + far2 / wide**2
            result[n] = cost if np.isfinite(cost) else np.inf
    return result


@compiled
def descent(
    epochs: Epochs,
    arc: Arcs,
    held: tuple[Array, Array],
    iterations: int,
    settings: Settings,
    place: Room,
    hold: Array,
) -> tuple[float, bool]:
    """Move an arc to where it fits best; return chi-square, and whether it has settled.

    Chi-square is infinite where no body is looked for. Information is written into zeros
    (11, 11), with the priors, of which ``held`` are centre (5) and information (5, 5).
    """
    least_gain, _, _, least, most, _ = settings
    step, damping = np.empty((1, 11)), 1e-6
    scratch = np.empty((11, 11)), np.empty(11), np.empty(11)
    pull, new_pull, new_hold = np.zeros(11), np.empty(11), np.empty((11, 11))
    chi2, lowest = _at(epochs, arc, held, settings, place, pull, hold)
    for _ in range(iterations):
        if _stepped(pull, hold, damping, step[0], scratch) < least_gain:
            return chi2, True
        ahead = displaced(arc[0], arc[1], arc[2], step)
        moved = ahead[0][0], ahead[1][0], ahead[2][0]
        new, total = _at(epochs, moved, held, settings, place, new_pull, new_hold)
        if total < lowest:
            chi2, lowest = new, total
            copy(new_pull, pull)
            copy_rows(new_hold, hold)
            for part in range(3):
                copy(moved[part], arc[part])
            damping = max(0.1 * damping, least)
        elif damping > most:
            break
        else:
            damping = max(10.0 * damping, 1e-6)
    return chi2, False


@compiled
def _at(
    epochs: Epochs,
    arc: Arcs,
    held: tuple[Array, Array],
    settings: Settings,
    place: Room,
    pull: Array,
    hold: Array,
) -> tuple[float, float]:
    """Return chi-square and cost, and write pull (11) and information (11, 11)."""
    _, wide, widest, _, _, turn = settings
    times, one, other, squares, longest = epochs
    q, rates, work = place
    logs = arc[2]
    if not np.sqrt(dot(logs, logs)) < widest:
        return np.inf, np.inf
    step, span, rate, log = np.empty(8), 1.0 + longest, np.empty(3), np.empty(5)
    turned = 1.0 + np.sqrt(dot(arc[1], arc[1])) * span
    for k in range(8):
        step[k] = turn / (span if k < 3 else turned)
    for k in range(9):
        for i in range(3):
            rate[i] = arc[1][i] + (step[i] if i == k - 1 else 0.0)
        for i in range(5):
            log[i] = logs[i] + (step[3 + i] if i == k - 4 else 0.0)
        motion(times, arc[0], rate, matrix_of(log), q[k], rates)
    chi2 = squares - 2.0 * normal(q, step, (one, other), work, pull, hold)
    total = chi2
    for i in range(5):
        pulled = 0.0
        for j in range(5):
            pulled += held[1][i, j] * (logs[j] - held[0][j])
            hold[6 + i, 6 + j] += held[1][i, j]
        pull[6 + i] -= logs[i] * wide**-2.0 + pulled
        hold[6 + i, 6 + i] += wide**-2.0
        total += logs[i] ** 2 / wide**2 + (logs[i] - held[0][i]) * pulled
    return chi2, total if np.isfinite(total) else np.inf


@compiled
def _stepped(
    pull: Array, hold: Array, damping: float, step: Array, scratch: tuple[Array, Array, Array]
) -> float:
    """Write the step (11), and return by how much it should lower the chi-square."""
    matrix, right, scale = scratch
    for i in range(11):
        scale[i] = 1.0 / np.sqrt(max(hold[i, i], np.finfo(np.float64).tiny))
    for i in range(11):
        right[i] = scale[i] * pull[i]
        for j in range(11):
            matrix[i, j] = scale[i] * hold[i, j] * scale[j]
        matrix[i, i] += damping
    solve(matrix, right)
    gain = 0.0
    for i in range(11):
        step[i] = scale[i] * right[i]
    for i in range(11):
        bent = 0.0
        for j in range(11):
            bent += hold[i, j] * step[j]
        gain += step[i] * (2.0 * pull[i] - bent)
    return gain
