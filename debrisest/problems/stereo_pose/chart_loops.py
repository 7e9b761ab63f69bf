"""The charts of `chart` of one run as plain loops, for `debrisest.compiled`.

A matrix is multiplied by a chart, or by a transposed one, in its rows, in place: of all its columns
at once, and of what is not zero alone.
"""

import math

import numpy as np

from debrisest.array_loops import copy, fill
from debrisest.arrays import Array
from debrisest.attitude.vector_loops import Vector, applied, applied_back, cross, vector
from debrisest.compiled import compiled
from debrisest.dynamics.inertia_ratios import NOT_CUT
from debrisest.dynamics.inertia_ratios_loops import by_ratios, reached, slopes
from debrisest.dynamics.inertia_ratios_loops import moved as ratios_moved


@compiled
def place(state: Array, turn: Array, arms: Array) -> None:
    """Write the axes (3, 3) of a state (n,), and the arms (N + 1, 3), their mean the last."""
    points = len(arms) - 1
    axes(state[9:13], turn)
    fill(0.0, arms[points])
    for i in range(points):
        arm = applied(turn, vector(state[15 + 3 * i :]))
        for c in range(3):
            arms[i, c] = arm[c]
            arms[points, c] += arm[c] / points


@compiled
def axes(q: Array, turn: Array) -> None:
    """Write the rotation matrix (3, 3) of a unit quaternion (4,)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    turn[0, 0], turn[1, 1] = 1.0 - 2.0 * (y * y + z * z), 1.0 - 2.0 * (x * x + z * z)
    turn[0, 1], turn[1, 0] = 2.0 * (x * y - w * z), 2.0 * (x * y + w * z)
    turn[0, 2], turn[2, 0] = 2.0 * (x * z + w * y), 2.0 * (x * z - w * y)
    turn[1, 2], turn[2, 1] = 2.0 * (y * z - w * x), 2.0 * (y * z + w * x)
    turn[2, 2] = 1.0 - 2.0 * (x * x + y * y)


@compiled
def by_plain(rate: Vector, turn: Array, arms: Array, matrix: Array, between: Array) -> None:
    """``G^T M`` of `chart.robocentric`; ``between (3, n_e)`` is for use in between."""
    points = len(arms) - 1
    mx, my, mz = vector(arms[points])
    wx, wy, wz = rate[0] / points, rate[1] / points, rate[2] / points
    for b in range(matrix.shape[1]):
        x, y, z = matrix[3, b], matrix[4, b], matrix[5, b]
        matrix[6, b] += my * z - mz * y
        matrix[7, b] += mz * x - mx * z
        matrix[8, b] += mx * y - my * x
        between[0, b] = wz * y - wy * z
        between[1, b] = wx * z - wz * x
        between[2, b] = wy * x - wx * y
    d00, d01, d02, d10, d11, d12, d20, d21, d22 = _elements(turn)
    for i in range(points):
        ax, ay, az = vector(arms[i])
        f = 14 + 3 * i
        for b in range(matrix.shape[1]):
            x, y, z = matrix[f, b], matrix[f + 1, b], matrix[f + 2, b]
            matrix[0, b] += x
            matrix[1, b] += y
            matrix[2, b] += z
            x, y, z = x + between[0, b], y + between[1, b], z + between[2, b]
            matrix[9, b] += ay * z - az * y
            matrix[10, b] += az * x - ax * z
            matrix[11, b] += ax * y - ay * x
            matrix[f, b] = d00 * x + d10 * y + d20 * z
            matrix[f + 1, b] = d01 * x + d11 * y + d21 * z
            matrix[f + 2, b] = d02 * x + d12 * y + d22 * z


@compiled
def by_own(rate: Vector, turn: Array, arms: Array, matrix: Array, between: Array) -> None:
    """``P^T M`` of `chart.plain`, as `by_plain`."""
    points = len(arms) - 1
    mx, my, mz = vector(arms[points])
    wx, wy, wz = rate
    per = 1.0 / points
    for b in range(matrix.shape[1]):
        x, y, z = matrix[3, b], matrix[4, b], matrix[5, b]
        matrix[6, b] -= my * z - mz * y
        matrix[7, b] -= mz * x - mx * z
        matrix[8, b] -= mx * y - my * x
        x, y, z = wy * z - wz * y, wz * x - wx * z, wx * y - wy * x
        matrix[0, b] -= x
        matrix[1, b] -= y
        matrix[2, b] -= z
        between[0, b], between[1, b], between[2, b] = per * x, per * y, per * z
    d00, d01, d02, d10, d11, d12, d20, d21, d22 = _elements(turn)
    for i in range(points):
        ax, ay, az = vector(arms[i])
        f = 14 + 3 * i
        for b in range(matrix.shape[1]):
            u, v, w = matrix[f, b], matrix[f + 1, b], matrix[f + 2, b]
            x = d00 * u + d01 * v + d02 * w
            y = d10 * u + d11 * v + d12 * w
            z = d20 * u + d21 * v + d22 * w
            matrix[0, b] -= x
            matrix[1, b] -= y
            matrix[2, b] -= z
            matrix[9, b] -= ay * z - az * y
            matrix[10, b] -= az * x - ax * z
            matrix[11, b] -= ax * y - ay * x
            matrix[f, b] = x + between[0, b]
            matrix[f + 1, b] = y + between[1, b]
            matrix[f + 2, b] = z + between[2, b]


@compiled
def to_plain(rate: Vector, turn: Array, arms: Array, matrix: Array) -> None:
    """``P M`` of `chart.plain`."""
    points = len(arms) - 1
    mx, my, mz = vector(arms[points])
    wx, wy, wz = rate
    per = 1.0 / points
    for i in range(points):
        f = 14 + 3 * i
        for b in range(matrix.shape[1]):
            x, y, z = per * matrix[f, b], per * matrix[f + 1, b], per * matrix[f + 2, b]
            matrix[3, b] -= wy * z - wz * y
            matrix[4, b] -= wz * x - wx * z
            matrix[5, b] -= wx * y - wy * x
    for b in range(matrix.shape[1]):
        x, y, z = matrix[0, b], matrix[1, b], matrix[2, b]
        u, v, w = matrix[6, b], matrix[7, b], matrix[8, b]
        matrix[3, b] += (wy * z - wz * y) + (my * w - mz * v)
        matrix[4, b] += (wz * x - wx * z) + (mz * u - mx * w)
        matrix[5, b] += (wx * y - wy * x) + (mx * v - my * u)
    d00, d01, d02, d10, d11, d12, d20, d21, d22 = _elements(turn)
    for i in range(points):
        ax, ay, az = vector(arms[i])
        f = 14 + 3 * i
        for b in range(matrix.shape[1]):
            u, v, w = matrix[9, b], matrix[10, b], matrix[11, b]
            x = matrix[f, b] - matrix[0, b] + (ay * w - az * v)
            y = matrix[f + 1, b] - matrix[1, b] + (az * u - ax * w)
            z = matrix[f + 2, b] - matrix[2, b] + (ax * v - ay * u)
            matrix[f, b] = d00 * x + d10 * y + d20 * z
            matrix[f + 1, b] = d01 * x + d11 * y + d21 * z
            matrix[f + 2, b] = d02 * x + d12 * y + d22 * z


@compiled
def excess(state: Array, step: Array) -> tuple[Array, Array]:
    """Return derivatives (run, 2, n_e) and what is cut (run, 2), as `chart.excess`."""
    rows, cut = np.zeros((len(step), 2, step.shape[1])), np.empty((len(step), 2))
    for run in range(len(step)):
        by, at = by_ratios(state[run, 13], state[run, 14]), slopes(state[run, 13], state[run, 14])
        for i in range(2):
            rise = 0.0
            for j in range(2):
                rows[run, i, 12 + j] = by[i][j]
                rise += by[i][j] * step[run, 12 + j]
            off = reached(at[2 * i], rise) - at[2 * i] - rise
            cut[run, i] = off if abs(off) > NOT_CUT else 0.0
    return rows, cut


@compiled
def moved(state: Array, step: Array) -> Array:
    """Return states (run, n) after steps (run, n_e) in plain errors, as `gauss_newton.move`."""
    result, points = state.copy(), (state.shape[1] - 15) // 3
    turn, arms, error = np.empty((3, 3)), np.empty((points + 1, 3)), np.empty(step.shape[1])
    for run in range(len(state)):
        place(state[run], turn, arms)
        to_own(vector(state[run, 6:]), turn, arms, step[run], error)
        retract(result[run], error, turn, arms)
    return result


@compiled
def to_own(rate: Vector, turn: Array, arms: Array, step: Array, error: Array) -> None:
    """Write a plain error (n_e,) in the chart of its own: ``G d`` of `chart.robocentric`."""
    points, turned = len(arms) - 1, vector(step[9:])
    copy(step[:14], error)
    mean = cross(turned, vector(arms[points]))
    for i in range(points):
        body = applied(turn, vector(step[14 + 3 * i :]))
        lever = cross(turned, vector(arms[i]))
        mean = (
            mean[0] + body[0] / points,
            mean[1] + body[1] / points,
            mean[2] + body[2] / points,
        )
        for c in range(3):
            error[14 + 3 * i + c] = step[c] + lever[c] + body[c]
    flow, faster = cross(rate, mean), cross(vector(step[6:]), vector(arms[points]))
    for c in range(3):
        error[3 + c] += flow[c] + faster[c]


@compiled
def retract(state: Array, error: Array, turn: Array, arms: Array) -> None:
    """Replace a state (n,), whose `place` is given and spoilt, as `chart.retract`."""
    points = len(arms) - 1
    flow = cross(vector(state[6:9]), vector(arms[points]))
    for c in range(3):
        state[c] += error[c]
        state[3 + c] += flow[c] + error[3 + c]
        state[6 + c] += error[6 + c]
        arms[points, c] -= error[c]
        for i in range(points):
            moves = error[14 + 3 * i + c]
            arms[i, c] += moves - error[c]
            arms[points, c] += moves / points
    flow = cross(vector(state[6:9]), vector(arms[points]))
    for c in range(3):
        state[3 + c] -= flow[c]
    _turn_by((error[9], error[10], error[11]), state[9:13])
    state[13], state[14] = ratios_moved(state[13], state[14], error[12], error[13])
    axes(state[9:13], turn)
    for i in range(points):
        body = applied_back(turn, vector(arms[i]))
        state[15 + 3 * i], state[16 + 3 * i], state[17 + 3 * i] = body


@compiled
def difference(state: Array, arms: Array, at: Array, at_arms: Array, error: Array) -> None:
    """Write the error (n_e,) that takes ``at`` to the state, as `chart.difference`."""
    points = len(arms) - 1
    flow = cross(vector(state[6:9]), vector(arms[points]))
    at_flow = cross(vector(at[6:9]), vector(at_arms[points]))
    turn = _turn_between(state[9:13], at[9:13])
    for c in range(3):
        error[c] = state[c] - at[c]
        error[3 + c] = (state[3 + c] + flow[c]) - (at[3 + c] + at_flow[c])
        error[6 + c] = state[6 + c] - at[6 + c]
        error[9 + c] = turn[c]
        for i in range(points):
            error[14 + 3 * i + c] = (state[c] + arms[i, c]) - (at[c] + at_arms[i, c])
    error[12], error[13] = state[13] - at[13], state[14] - at[14]


@compiled
def _elements(turn: Array) -> tuple[float, ...]:
    a, b, c = turn[0, 0], turn[0, 1], turn[0, 2]
    d, e, f = turn[1, 0], turn[1, 1], turn[1, 2]
    return a, b, c, d, e, f, turn[2, 0], turn[2, 1], turn[2, 2]


@compiled
def _turn_by(rotation: Vector, q: Array) -> None:
    """Replace a quaternion by the one that is turned from the left."""
    angle = math.sqrt(rotation[0] ** 2 + rotation[1] ** 2 + rotation[2] ** 2)
    scale = math.sin(0.5 * angle) / angle if angle > 0.0 else 0.5
    a, b = math.cos(0.5 * angle), scale * rotation[0]
    c, d = scale * rotation[1], scale * rotation[2]
    w, x, y, z = q[0], q[1], q[2], q[3]
    q[0], q[1] = a * w - b * x - c * y - d * z, a * x + b * w + c * z - d * y
    q[2], q[3] = a * y - b * z + c * w + d * x, a * z + b * y - c * x + d * w


@compiled
def _turn_between(q: Array, at: Array) -> Vector:
    """Rotation vector from ``at`` to ``q``, as `quaternion.log`."""
    a, b, c, d = q[0], q[1], q[2], q[3]
    w, x, y, z = at[0], -at[1], -at[2], -at[3]
    scalar = a * w - b * x - c * y - d * z
    axis = (
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )
    sine = math.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
    ratio = 2.0 * math.atan2(sine, abs(scalar)) / sine if sine != 0.0 else 2.0
    ratio = -ratio if scalar < 0.0 else ratio
    return ratio * axis[0], ratio * axis[1], ratio * axis[2]
