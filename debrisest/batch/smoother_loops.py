"""The smoother's filter and its way back on known points as plain loops, for `debrisest.compiled`.

The steps are those of `smoother`, where their words are.
"""

import math

import numpy as np

from debrisest.array_loops import copy, copy_rows, dot, multiply
from debrisest.arrays import Array, IntArray
from debrisest.attitude.rotation_loops import (
    Quaternion,
    conjugated,
    inner,
    multiplied,
    rows_of,
    turn_of,
    turned_by,
)
from debrisest.batch.known_points_loops import Sums
from debrisest.batch.normal_loops import said
from debrisest.compiled import compiled
from debrisest.linear_algebra_loops import mirror, solve

Clock = tuple[Array, IntArray]
"""Steps before each time, s, and the epoch that is measured there, -1 if none."""
State = tuple[Array, Array, Array]
"""Attitude (4), rate and perhaps acceleration (3 or 6), and covariance (n, n)."""
_UPDATES = 2
_FACTORIAL = (1.0, 1.0, 2.0)


@compiled
def likelihoods(clock: Clock, sums: Sums, start: State, intensity: Array) -> tuple[Array, Array]:
    """Return misfit and volume (intensity,) of filters with several intensities."""
    misfit, volume = np.zeros(len(intensity)), np.zeros(len(intensity))
    n = len(start[2])
    transition, taylor, noise = np.eye(n), np.empty((n // 3, n // 3)), np.empty((n // 3, n // 3))
    for one in range(len(intensity)):
        state, last = (start[0].copy(), start[1].copy(), start[2].copy()), -1.0
        for k in range(len(clock[0])):
            if clock[0][k] != last:
                last = clock[0][k]
                _chain(last, taylor, noise)
            _predict(state, taylor, noise, intensity[one], transition)
            if clock[1][k] >= 0:
                more, wider = _update(state, sums, clock[1][k])
                misfit[one] += more
                volume[one] += wider
    return misfit, volume


@compiled
def smoothed(
    clock: Clock, sums: Sums, start: State, intensity: float
) -> tuple[Array, Array, Array]:
    """Return attitudes (time, 4), motions (time, 3 or 6) and covariances (time, n, n)."""
    times, n = len(clock[0]), len(start[2])
    taylor, noise = np.empty((n // 3, n // 3)), np.empty((n // 3, n // 3))
    q, motion, spread = np.empty((times, 4)), np.empty((times, n - 3)), np.empty((times, n, n))
    ahead = np.empty((times, 4)), np.empty((times, n - 3)), np.empty((times, n, n))
    transition = np.zeros((times, n, n))
    state = start[0].copy(), start[1].copy(), start[2].copy()
    for k in range(times):
        _chain(clock[0][k], taylor, noise)
        for i in range(n):
            transition[k, i, i] = 1.0
        _predict(state, taylor, noise, intensity, transition[k])
        _keep(state, (ahead[0][k], ahead[1][k], ahead[2][k]))
        if clock[1][k] >= 0:
            _update(state, sums, clock[1][k])
        _keep(state, (q[k], motion[k], spread[k]))
    for k in range(times - 2, -1, -1):
        predicted = ahead[0][k + 1], ahead[1][k + 1], ahead[2][k + 1]
        after = q[k + 1], motion[k + 1], spread[k + 1]
        _back((q[k], motion[k], spread[k]), predicted, after, transition[k + 1])
    return q, motion, spread


@compiled
def _keep(state: State, to: State) -> None:
    copy(state[0], to[0])
    copy(state[1], to[1])
    copy_rows(state[2], to[2])


@compiled
def _chain(step: float, taylor: Array, noise: Array) -> None:
    """Write how integrators in a row go on over a step, the last fed by white noise."""
    order = len(taylor)
    for i in range(order):
        for j in range(order):
            left, right = order - 1 - i, order - 1 - j
            power = left + right + 1
            noise[i, j] = step**power / (power * _FACTORIAL[left] * _FACTORIAL[right])
            taylor[i, j] = step ** (j - i) / _FACTORIAL[j - i] if j >= i else 0.0


@compiled
def _predict(
    state: State, taylor: Array, noise: Array, intensity: float, transition: Array
) -> None:
    """Move a state over a step, and write the transition, whose lower part is kept."""
    q, motion, spread = state
    order, n = len(taylor), len(spread)
    x, y, z = 0.0, 0.0, 0.0
    for i in range(order - 1):
        x += taylor[0, 1 + i] * motion[3 * i]
        y += taylor[0, 1 + i] * motion[3 * i + 1]
        z += taylor[0, 1 + i] * motion[3 * i + 2]
    before = (q[0], q[1], q[2], q[3])
    rows = rows_of(multiplied(before, turned_by((0.5 * x, 0.5 * y, 0.5 * z))))
    q[0], q[1], q[2], q[3] = multiplied(before, turned_by((x, y, z)))
    for i in range(order - 1):
        for a in range(3):
            motion[3 * i + a] = _onward(taylor, motion, i, a)
    for i in range(order):
        for j in range(i + 1, order):
            for a in range(3):
                for b in range(3):
                    same = rows[a][b] if i == 0 else (1.0 if a == b else 0.0)
                    transition[3 * i + a, 3 * j + b] = taylor[i, j] * same
    half = np.empty((n, n))
    for a in range(n):
        for b in range(n):
            total = 0.0
            for c in range(a, n):
                total += transition[a, c] * spread[c, b]
            half[a, b] = total
    for a in range(n):
        for b in range(n):
            total = 0.0
            for c in range(b, n):
                total += half[a, c] * transition[b, c]
            i, j = a // 3, b // 3
            if i == 0 and j > 0:
                total += intensity * noise[i, j] * rows[a][b % 3]
            elif j == 0 and i > 0:
                total += intensity * noise[i, j] * rows[b][a % 3]
            elif a % 3 == b % 3:
                total += intensity * noise[i, j]
            spread[a, b] = total


@compiled
def _onward(taylor: Array, motion: Array, i: int, a: int) -> float:
    """One component of the motion after a step, those after it being as before."""
    total = 0.0
    for j in range(i, len(taylor) - 1):
        total += taylor[1 + i, 1 + j] * motion[3 * j + a]
    return total


@compiled
def _update(state: State, sums: Sums, epoch: int) -> tuple[float, float]:
    """Take what an epoch says, and return what it adds to misfit and volume."""
    q, motion, spread = state
    n, misfit, volume = len(spread), 0.0, 0.0
    before = (q[0], q[1], q[2], q[3])
    gain, error, hold = np.empty((n, 3)), np.zeros(n), np.empty((3, 3))
    for update in range(_UPDATES):
        at = multiplied(turned_by((error[0], error[1], error[2])), before)
        fit, pull, ((a, b, c), (d, e, f)) = said((sums[0], sums[1]), rows_of(at), epoch)
        hold[0, 0], hold[0, 1], hold[0, 2], hold[1, 1], hold[1, 2], hold[2, 2] = a, b, c, d, e, f
        mirror(hold)
        size = _gain(spread, hold, gain)
        off = (error[0], error[1], error[2])
        pulled = (
            pull[0] + inner((a, b, c), off),
            pull[1] + inner((b, d, e), off),
            pull[2] + inner((c, e, f), off),
        )
        for k in range(n):
            error[k] = inner((gain[k, 0], gain[k, 1], gain[k, 2]), pulled)
        if update == 0:
            misfit = sums[2][epoch] - 2.0 * fit - inner(pull, (error[0], error[1], error[2]))
            misfit = misfit if size > 0.0 else np.inf
            volume = math.log(size) if size > 0.0 else 0.0
    q[0], q[1], q[2], q[3] = multiplied(turned_by((error[0], error[1], error[2])), before)
    for k in range(n - 3):
        motion[k] += error[3 + k]
    weighed, taken = np.empty((n, 3)), np.empty((n, n))
    multiply(gain, hold, weighed)
    multiply(weighed, spread[:3], taken)
    for i in range(n):
        for j in range(i + 1):
            both = spread[i, j] - taken[i, j] + spread[j, i] - taken[j, i]
            spread[i, j] = spread[j, i] = 0.5 * both
    return misfit, volume


@compiled
def _gain(spread: Array, hold: Array, gain: Array) -> float:
    """Write the gain (n, 3) of what tells of the attitude; return how much wider its errors were.

    That is zero where no matrix can be inverted.
    """
    wider = np.eye(3)
    for i in range(3):
        for j in range(3):
            for k in range(3):
                wider[i, j] += hold[i, k] * spread[k, j]
    inverse, sound = np.empty((3, 3)), True
    for i in range(3):
        for j in range(3):
            sound = sound and np.isfinite(wider[i, j])
            k, m, r, s = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            inverse[j, i] = wider[k, r] * wider[m, s] - wider[k, s] * wider[m, r]
    size = wider[0, 0] * inverse[0, 0] + wider[0, 1] * inverse[1, 0] + wider[0, 2] * inverse[2, 0]
    sound = sound and np.isfinite(size) and size != 0.0
    for a in range(len(spread)):
        for j in range(3):
            gain[a, j] = spread[a, j]
            if sound:
                total = spread[a, 0] * inverse[0, j] + spread[a, 1] * inverse[1, j]
                gain[a, j] = (total + spread[a, 2] * inverse[2, j]) / size
    return abs(size) if sound else 0.0


@compiled
def _back(state: State, ahead: State, after: State, transition: Array) -> None:
    """Move a filtered state and its covariance to what all measurements say."""
    q, motion, spread = state
    n = len(spread)
    scale, error, column = np.empty(n), np.empty(n), np.empty(n)
    matrix, gain, half, more = (
        np.empty((n, n)),
        np.empty((n, n)),
        np.empty((n, n)),
        np.empty((n, n)),
    )
    multiply(transition, spread, half)
    for i in range(n):
        scale[i] = math.sqrt(ahead[2][i, i])
    for i in range(n):
        for a in range(n):
            column[a] = half[a, i] / scale[a]
            for b in range(n):
                matrix[a, b] = ahead[2][a, b] / (scale[a] * scale[b])
        solve(matrix, column)
        for a in range(n):
            gain[i, a] = column[a] / scale[a]
    error[0], error[1], error[2] = turn_of(multiplied(_four(after[0]), conjugated(_four(ahead[0]))))
    for i in range(n - 3):
        error[3 + i] = after[1][i] - ahead[1][i]
    for i in range(n):
        column[i] = dot(gain[i], error)
        for j in range(n):
            more[i, j] = after[2][i, j] - ahead[2][i, j]
    turn = turned_by((column[0], column[1], column[2]))
    q[0], q[1], q[2], q[3] = multiplied(turn, _four(q))
    for i in range(n - 3):
        motion[i] += column[3 + i]
    multiply(gain, more, half)
    for i in range(n):
        for j in range(n):
            spread[i, j] += dot(half[i], gain[j])


@compiled
def _four(q: Array) -> Quaternion:
    return q[0], q[1], q[2], q[3]
