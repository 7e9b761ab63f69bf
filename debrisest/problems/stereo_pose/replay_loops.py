"""Normal equations of the points before two cameras as plain loops, for `debrisest.compiled`.

Equations are those of `replay.point_rows` and of `sensors/stereo.py`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude.rotation_loops import matrix_of
from debrisest.attitude.vector_loops import Vector, applied, applied_back, cross, vector
from debrisest.compiled import compiled
from debrisest.linear_algebra_loops import mirror
from debrisest.problems.stereo_pose.point_loops import add_row, rows_of_point


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
    by, shown = np.zeros((each, 6)), np.empty(each)
    square, pull, by_arm = np.empty((6, 6)), np.empty(6), np.empty((15, 3))
    joint, total, moved = np.empty((12, n_e - 2)), np.empty(12), np.empty((14, n_e - 2))
    for run in range(runs):
        for k in range(epochs):
            state, turn = states[run, k], matrix_of(states[run, k, 9:13])
            rate = state[6], state[7], state[8]
            joint[:], total[:] = 0.0, 0.0
            for point in range(points):
                body = state[15 + 3 * point : 18 + 3 * point]
                arm = applied(turn, vector(body))
                rows_of_point(state, arm, camera, rows, shown, by)
                square[:], pull[:] = 0.0, 0.0
                for i in range(each):
                    m = each * point + i
                    left = measured[run, k, m] - shown[i] / noise[m]
                    residual[run, k, m] = left
                    left *= weight[run, k, m]
                    cost[run] += left * left
                    flows = 4 <= rows[i] < 8
                    add_row(by[i], weight[run, k, m] / noise[m], left, flows, square, pull)
                first = 14 + 3 * point
                told = _add_point(square, pull, arm, rate, by_arm, joint, total)
                _to_body(turn, by_arm, joint[:, first - 2 : first + 1])
                told = applied_back(turn, told)
                for a in range(3):
                    gradient[run, first + a] += told[a]
                    for b in range(3):
                        information[run, first + a, first + b] += by_arm[12 + a, b]
            at = turning[run, k], centre[k]
            _add_motion(joint, total, *at, moved, information[run], gradient[run])
        mirror(information[run])
    return residual, information, gradient, cost


@compiled
def _add_point(
    square: Array,
    pull: Array,
    arm: Vector,
    rate: Vector,
    by_arm: Array,
    whole: Array,
    total: Array,
) -> Vector:
    """Add what place and velocity of a point tell of the motion; return the pull of its arm.

    Of ``whole`` that is above the diagonal. ``by_arm (15, 3)`` is written: what position, velocity,
    rate, attitude and the arm itself tell together with the arm.
    """
    for i in range(6):
        for j in range(i):
            square[i, j] = square[j, i]
    for i in range(6):
        flow = square[i, 3], square[i, 4], square[i, 5]
        turned, spun = cross(flow, rate), cross(arm, flow)
        for j in range(3):
            by_arm[i, j] = square[i, j] + turned[j]
            whole[i, 6 + j] += spun[j]
        for j in range(i, 6):
            whole[i, j] += square[i, j]
    for j in range(3):
        flow = by_arm[3, j], by_arm[4, j], by_arm[5, j]
        turned, spun = cross(flow, rate), cross(arm, flow)
        of_arm = by_arm[0, j] + turned[0], by_arm[1, j] + turned[1], by_arm[2, j] + turned[2]
        attitude = cross(arm, of_arm)
        for i in range(3):
            by_arm[6 + i, j], by_arm[9 + i, j], by_arm[12 + i, j] = spun[i], attitude[i], of_arm[i]
    _add_turns(square, by_arm, arm, whole)
    flow = pull[3], pull[4], pull[5]
    turned, spun = cross(flow, rate), cross(arm, flow)
    of_arm = pull[0] + turned[0], pull[1] + turned[1], pull[2] + turned[2]
    attitude = cross(arm, of_arm)
    for i in range(3):
        total[i] += pull[i]
        total[3 + i] += pull[3 + i]
        total[6 + i] += spun[i]
        total[9 + i] += attitude[i]
    return of_arm


@compiled
def _add_turns(square: Array, by_arm: Array, arm: Vector, whole: Array) -> None:
    """Add what rate and attitude tell by themselves, and the attitude with all."""
    x = cross(arm, (square[3, 3], square[4, 3], square[5, 3]))
    y = cross(arm, (square[3, 4], square[4, 4], square[5, 4]))
    z = cross(arm, (square[3, 5], square[4, 5], square[5, 5]))
    for i in range(3):
        spun = cross(arm, (x[i], y[i], z[i]))
        for j in range(3):
            whole[6 + i, 6 + j] += spun[j]
    for i in range(12):
        attitude = cross(arm, (by_arm[i, 0], by_arm[i, 1], by_arm[i, 2]))
        for j in range(3):
            whole[i, 9 + j] += attitude[j]


@compiled
def _to_body(turn: Array, by_arm: Array, own: Array) -> None:
    """Write what motion and point in the body tell together (12, 3), and the latter by itself.

    That takes the place of what the arm tells by itself, the last of ``by_arm (15, 3)``.
    """
    for i in range(15):
        told = applied_back(turn, (by_arm[i, 0], by_arm[i, 1], by_arm[i, 2]))
        place = own[i] if i < 12 else by_arm[i]
        place[0], place[1], place[2] = told
    for j in range(3):
        told = applied_back(turn, (by_arm[12, j], by_arm[13, j], by_arm[14, j]))
        by_arm[12, j], by_arm[13, j], by_arm[14, j] = told


@compiled
def _add_motion(
    joint: Array,
    total: Array,
    turning: Array,
    centre: Array,
    moved: Array,
    information: Array,
    gradient: Array,
) -> None:
    """Add what an epoch tells, ``joint (12, 12 + 3N)``, by the errors of the motion at the start.

    Of the motion by itself, the first twelve, what is above the diagonal is given.
    """
    for a in range(12):
        for b in range(a):
            joint[a, b] = joint[b, a]
    moved[:] = 0.0
    for c in range(6):
        for a in range(6):
            gradient[a] += centre[c, a] * total[c]
            for b in range(joint.shape[1]):
                moved[a, b] += centre[c, a] * joint[c, b]
        for a in range(8):
            gradient[6 + a] += turning[c, a] * total[6 + c]
            for b in range(joint.shape[1]):
                moved[6 + a, b] += turning[c, a] * joint[6 + c, b]
    for a in range(14):
        for c in range(6):
            for b in range(6):
                information[a, b] += moved[a, c] * centre[c, b]
            for b in range(8):
                information[a, 6 + b] += moved[a, 6 + c] * turning[c, b]
        for b in range(12, joint.shape[1]):
            information[a, 2 + b] += moved[a, b]
