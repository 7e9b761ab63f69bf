"""The descents of `descent` on known points as plain loops, for `debrisest.compiled`."""

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.attitude.rotation_loops import product
from debrisest.batch.arc_loops import along, derivatives
from debrisest.batch.point_loops import normal
from debrisest.compiled import compiled
from debrisest.dynamics.log_inertia import BASIS
from debrisest.linear_algebra_loops import solve

Arcs = tuple[Array, Array, Array]
"""Attitude (4), rate (3) and log-ratios (5) of an arc at its epoch."""
Told = tuple[Array, Array, Array, float]
"""Times since the epoch, and sums of known points: two of each epoch (time, 3, 3), and squares."""
Settings = tuple[float, float, float, float, float, float]
"""Least gain, sigma of the wide prior, widest log-ratios, least damping, most, turn of a step."""


@compiled
def descents(
    told: Told, arcs: Arcs, held: tuple[Array, Array], iterations: int, settings: Settings
) -> tuple[Array, Array, BoolArray]:
    """Move the ``arcs (arc, ...)`` to where they fit best.

    Return chi-squares (arc,), infinite where no body is looked for, information (arc, 11, 11) with
    the priors, of which ``held`` are centre (arc, 5) and information (arc, 5, 5), and which arcs
    have settled.
    """
    count = len(arcs[0])
    chi2, holds = np.empty(count), np.empty((count, 11, 11))
    settled = np.zeros(count, dtype=np.bool_)
    for n in range(count):
        arc, prior = (arcs[0][n], arcs[1][n], arcs[2][n]), (held[0][n], held[1][n])
        chi2[n], settled[n] = _descent(told, arc, prior, iterations, settings, holds[n])
    return chi2, holds, settled


@compiled
def _descent(
    told: Told,
    arc: Arcs,
    held: tuple[Array, Array],
    iterations: int,
    settings: Settings,
    hold: Array,
) -> tuple[float, bool]:
    """Move one arc, and write its information."""
    least_gain, _, _, least, most, _ = settings
    step, damping = np.empty(11), 1e-6
    chi2, lowest, pull, hold[:] = _at(told, arc, held, settings)
    for _ in range(iterations):
        if _stepped(pull, hold, damping, step) < least_gain:
            return chi2, True
        moved = _displaced(arc, step)
        new, total, new_pull, new_hold = _at(told, moved, held, settings)
        if total < lowest:
            chi2, lowest, pull, hold[:] = new, total, new_pull, new_hold
            arc[0][:], arc[1][:], arc[2][:] = moved
            damping = max(0.1 * damping, least)
        elif damping > most:
            break
        else:
            damping = max(10.0 * damping, 1e-6)
    return chi2, False


@compiled
def _at(
    told: Told, arc: Arcs, held: tuple[Array, Array], settings: Settings
) -> tuple[float, float, Array, Array]:
    """Chi-square, cost, pull (11) and information (11, 11)."""
    _, wide, widest, _, _, turn = settings
    times, logs = told[0], arc[2]
    if not np.sqrt(np.sum(logs**2)) < widest:
        return np.inf, np.inf, np.zeros(11), np.zeros((11, 11))
    step, span = np.empty((1, 8)), 1.0
    for t in range(len(times)):
        span = max(span, 1.0 + abs(times[t]))
    step[0, :3], step[0, 3:] = turn / span, turn / (1.0 + np.sqrt(np.sum(arc[1] ** 2)) * span)
    q, rate = along(times, *_copies(arc, step[0]))
    turn_by, _ = derivatives(q.reshape(1, 9, -1, 4), rate.reshape(1, 9, -1, 3), step)
    fits, pulls, holds = normal(q[:1], turn_by, told[1], told[2])
    off = logs - held[0]
    pulled = held[1] @ off
    pulls[0, 6:] -= logs * wide**-2.0 + pulled
    holds[0, 6:, 6:] += held[1]
    for i in range(6, 11):
        holds[0, i, i] += wide**-2.0
    chi2 = told[3] - 2.0 * fits[0]
    total = chi2 + np.sum(logs**2) / wide**2 + np.sum(off * pulled)
    return chi2, total if np.isfinite(total) else np.inf, pulls[0], holds[0]


@compiled
def _copies(arc: Arcs, step: Array) -> tuple[Array, Array, Array]:
    """Attitudes, rates and log-ratios as matrices of an arc, and of eight beside it."""
    q, rate, logs = np.empty((9, 4)), np.empty((9, 3)), np.zeros((9, 3, 3))
    for n in range(9):
        q[n], rate[n] = arc[0], arc[1]
        for k in range(5):
            logs[n] += arc[2][k] * BASIS[k]
    for n in range(3):
        rate[n + 1, n] += step[n]
    for k in range(5):
        logs[k + 4] += step[3 + k] * BASIS[k]
    return q, rate, logs


@compiled
def _displaced(arc: Arcs, error: Array) -> Arcs:
    """The arc moved by an error (11)."""
    angle = np.sqrt(np.sum(error[:3] ** 2))
    turn = np.empty(4)
    turn[0] = np.cos(0.5 * angle)
    turn[1:] = (0.5 if angle == 0.0 else np.sin(0.5 * angle) / angle) * error[:3]
    return product(turn, arc[0]), arc[1] + error[3:6], arc[2] + error[6:]


@compiled
def _stepped(pull: Array, hold: Array, damping: float, step: Array) -> float:
    """Write the step (11), and return by how much it should lower the chi-square."""
    matrix, right, scale = np.empty((11, 11)), np.empty(11), np.empty(11)
    for i in range(11):
        scale[i] = 1.0 / np.sqrt(max(hold[i, i], np.finfo(np.float64).tiny))
    for i in range(11):
        right[i] = scale[i] * pull[i]
        for j in range(11):
            matrix[i, j] = scale[i] * hold[i, j] * scale[j]
        matrix[i, i] += damping
    solve(matrix, right)
    step[:] = scale * right
    gain = 0.0
    for i in range(11):
        bent = 0.0
        for j in range(11):
            bent += hold[i, j] * step[j]
        gain += step[i] * (2.0 * pull[i] - bent)
    return gain
