"""Normal equations of the points before two cameras as plain loops, for `debrisest.compiled`.

Equations are those of `replay.point_rows` and of `sensors/stereo.py`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude.rotation_loops import matrix_of
from debrisest.compiled import compiled

Vector = tuple[float, float, float]
_OWN = 15  # errors of an epoch that a point's rows depend on: 12 of the motion, 3 of the point


@compiled
def point_sums(
    states: Array,
    turning: Array,
    centre: Array,
    camera: tuple[Array, float],
    rows: IntArray,
    noise: Array,
    measured: Array,
    weight: Array,
) -> tuple[Array, Array, Array, Array]:
    """Return residuals (run, epoch, N rows), information, gradient and cost of all epochs.

    As `normal_equations.point_equations`. ``states (run, epoch, 15 + 3N)``, ``turning (run, epoch,
    6, 8)``, ``centre (epoch, 6, 6)``; a camera has its axes (3, 3) in the leader's, and the
    baseline; ``rows (r,)`` are those of `stereo.measure`, ``noise (N r,)``; what is measured is
    normalised.
    """
    runs, epochs = states.shape[:2]
    each = len(rows)
    points = (states.shape[2] - 15) // 3
    n_e = 14 + 3 * points
    residual, information = np.empty((runs, epochs, len(noise))), np.zeros((runs, n_e, n_e))
    gradient, cost = np.zeros((runs, n_e)), np.zeros(runs)
    by, shown = np.empty((each, _OWN)), np.empty(each)
    own, pull = np.empty((_OWN, 3)), np.empty(_OWN)
    whole, total, moved = np.empty((12, 12)), np.empty(12), np.empty((12, 14))
    for run in range(runs):
        for k in range(epochs):
            state, turn = states[run, k], matrix_of(states[run, k, 9:13])
            at = turning[run, k], centre[k]
            whole[:], total[:] = 0.0, 0.0
            for point in range(points):
                _rows(state, turn, state[15 + 3 * point : 18 + 3 * point], camera, rows, shown, by)
                own[:], pull[:] = 0.0, 0.0
                for i in range(each):
                    m = each * point + i
                    left = measured[run, k, m] - shown[i] / noise[m]
                    residual[run, k, m] = left
                    left *= weight[run, k, m]
                    cost[run] += left * left
                    _add_row(by[i], weight[run, k, m] / noise[m], left, whole, own, pull)
                first = 14 + 3 * point
                total += pull[:12]
                gradient[run, first : first + 3] += pull[12:]
                _add_own(own, *at, first, information[run])
            _add_whole(whole, total, *at, moved, information[run], gradient[run])
        for a in range(n_e):
            for b in range(a):
                information[run, a, b] = information[run, b, a]
    return residual, information, gradient, cost


@compiled
def _add_row(by: Array, scale: float, left: float, whole: Array, own: Array, pull: Array) -> None:
    """Add a row's squares: of the motion, above the diagonal, and with its point."""
    for a in range(_OWN):
        by[a] *= scale
    for a in range(_OWN):
        if by[a] != 0.0:
            pull[a] += by[a] * left
            for b in range(a, 12):
                whole[a, b] += by[a] * by[b]
            for b in range(3):
                own[a, b] += by[a] * by[12 + b]


@compiled
def _rows(
    state: Array,
    turn: Array,
    body: Array,
    camera: tuple[Array, float],
    rows: IntArray,
    shown: Array,
    by: Array,
) -> None:
    """Write what a point shows (r,), and its derivative (r, 15) by the errors of the epoch."""
    axes, baseline = camera
    rate, arm = (state[6], state[7], state[8]), _applied(turn, body[0], body[1], body[2])
    moved = _cross(rate, arm)
    point = _applied(axes, state[0] + arm[0], state[1] + arm[1], state[2] + arm[2])
    velocity = _applied(axes, state[3] + moved[0], state[4] + moved[1], state[5] + moved[2])
    near = 1.0 / point[1]
    recede = velocity[1] * near
    for i in range(len(rows)):
        row, across = rows[i], 2 * (rows[i] % 2)
        slope = (point[across] - (baseline if row % 4 == 2 else 0.0)) * near
        side, ahead, flow = near, -slope * near, False
        if row < 4:
            shown[i] = slope
        elif row < 8:
            shown[i], flow = (velocity[across] - slope * velocity[1]) * near, True
            side, ahead = -recede * near, (slope * recede - shown[i]) * near
        else:
            shown[i], side, ahead = -baseline * near, 0.0, baseline * near * near
        by_point = _row(axes, across, side, ahead)
        by_velocity = _row(axes, across, near, -slope * near) if flow else (0.0, 0.0, 0.0)
        _write(by_point, by_velocity, arm, rate, turn, by[i])


@compiled
def _write(
    by_point: Vector, by_velocity: Vector, arm: Vector, rate: Vector, turn: Array, by: Array
) -> None:
    """Write a row by position, velocity, rate, attitude and the point in the body."""
    more = _cross(by_velocity, rate)
    by_arm = (by_point[0] + more[0], by_point[1] + more[1], by_point[2] + more[2])
    by_rate, by_turn = _cross(arm, by_velocity), _cross(arm, by_arm)
    for i in range(3):
        by[i], by[3 + i], by[6 + i], by[9 + i] = by_point[i], by_velocity[i], by_rate[i], by_turn[i]
        by[12 + i] = by_arm[0] * turn[0, i] + by_arm[1] * turn[1, i] + by_arm[2] * turn[2, i]


@compiled
def _add_own(own: Array, turning: Array, centre: Array, first: int, information: Array) -> None:
    """Add what a point has with the motion, and by itself."""
    for a in range(6):
        for b in range(6):
            for c in range(3):
                information[b, first + c] += centre[a, b] * own[a, c]
        for b in range(8):
            for c in range(3):
                information[6 + b, first + c] += turning[a, b] * own[6 + a, c]
    for b in range(3):
        for c in range(3):
            information[first + b, first + c] += own[12 + b, c]


@compiled
def _add_whole(
    whole: Array,
    total: Array,
    turning: Array,
    centre: Array,
    moved: Array,
    information: Array,
    gradient: Array,
) -> None:
    """Add what the points together tell of the motion, by its errors at the start."""
    moved[:] = 0.0
    for a in range(12):
        for c in range(6):
            left = whole[a, c] if a < c else whole[c, a]
            right = whole[a, 6 + c] if a < 6 + c else whole[6 + c, a]
            for b in range(6):
                moved[a, b] += left * centre[c, b]
            for b in range(8):
                moved[a, 6 + b] += right * turning[c, b]
    for c in range(6):
        for a in range(6):
            gradient[a] += centre[c, a] * total[c]
            for b in range(a, 14):
                information[a, b] += centre[c, a] * moved[c, b]
        for a in range(8):
            gradient[6 + a] += turning[c, a] * total[6 + c]
            for b in range(6 + a, 14):
                information[6 + a, b] += turning[c, a] * moved[6 + c, b]


@compiled
def _applied(matrix: Array, x: float, y: float, z: float) -> Vector:
    return (
        matrix[0, 0] * x + matrix[0, 1] * y + matrix[0, 2] * z,
        matrix[1, 0] * x + matrix[1, 1] * y + matrix[1, 2] * z,
        matrix[2, 0] * x + matrix[2, 1] * y + matrix[2, 2] * z,
    )


@compiled
def _row(axes: Array, across: int, side: float, ahead: float) -> Vector:
    """A vector in the leader's axes, of its components across and ahead in a camera's."""
    return (
        side * axes[across, 0] + ahead * axes[1, 0],
        side * axes[across, 1] + ahead * axes[1, 1],
        side * axes[across, 2] + ahead * axes[1, 2],
    )


@compiled
def _cross(u: Vector, v: Vector) -> Vector:
    return u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]
