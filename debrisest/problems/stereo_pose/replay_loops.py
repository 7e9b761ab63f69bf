"""Normal equations of the points before two cameras as plain loops, for `debrisest.compiled`.

Equations are those of `replay.point_rows`, where their words are. What points tell of the motion
at an epoch is summed up before it is told of that at the start, `LANES` epochs at once.
"""

import numpy as np

from debrisest.array_loops import fill
from debrisest.arrays import Array, IntArray
from debrisest.compiled import compiled
from debrisest.problems.stereo_pose.lane_loops import (
    LANES,
    add_six,
    add_two,
    forces,
    shown_of,
    to_body,
    told_by_rows,
    told_of_arm,
    weighted,
)

_TURNS = 36  # lanes of `way` that come before those of the rotation


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
) -> tuple[Array, Array, Array]:
    """Return information, gradient and cost of all epochs, as `measured_arc.sums`.

    As `normal_equations.point_equations`. ``states (run, epoch, 15 + 3N)``, ``turning (run, epoch,
    6, 8)``, ``centre (6, 6, epoch + LANES)`` by the start, the number
    in the cameras' axes, and the epoch; a camera has its axes (3, 3) in the leader's, and the
    baseline; ``rows (r,)`` are those of `stereo.measure`, ``noise (m,)``; what is measured is
    normalised, and its first N r columns are those of the points, the others are left alone.
    """
    (runs, epochs), points = states.shape[:2], (states.shape[2] - 15) // 3
    n_e = 14 + 3 * points
    information, gradient, cost = np.zeros((runs, n_e, n_e)), np.zeros((runs, n_e)), np.zeros(runs)
    body, way = np.empty(18 * LANES), np.empty(84 * LANES)
    view = np.empty(3 * LANES), np.empty(8 * LANES), np.empty(9 * LANES)
    told = np.zeros(9 * LANES), np.zeros(9 * LANES)
    parts = np.empty(36 * LANES), np.empty(6 * LANES), np.empty(45 * LANES), np.empty(18 * LANES)
    joint, force, own = np.empty(108 * LANES), np.empty(12 * LANES), np.empty(3 * LANES)
    sums, pulls, costs = np.empty(14 * n_e * LANES), np.empty(n_e * LANES), np.empty(LANES)
    owns = np.empty(9 * points * LANES)
    for run in range(runs):
        for part in (sums, pulls, costs, owns):
            fill(0.0, part)
        seen = measured[run], weight[run]
        for first in range(0, epochs, LANES):
            count = min(LANES, epochs - first)
            width = 8 * ((count + 7) // 8)
            _gather(states[run], camera[0], first, count, width, body)
            _gather_ways(turning[run], centre, camera[0], first, count, width, way)
            fill(0.0, joint)
            fill(0.0, force)
            for i in range(points):
                place = states[run, first, 15 + 3 * i : 18 + 3 * i]
                arm, at, shown = view
                shown_of(body, place, camera[1], width, arm, at, shown)
                weighted(seen, noise, rows, (i, first, count, width), shown, *told, costs)
                square, push, by_arm, by_rate = parts
                told_by_rows(*told, at, camera[1], width, square, push)
                told_of_arm(square, arm, body, width, by_arm, by_rate, joint)
                to_body(by_arm, body, width)
                forces(push, arm, body, width, force, own)
                lane = LANES * (14 + 3 * i)
                into = sums[14 * lane :], pulls[lane:], owns[9 * LANES * i :]
                _add_point(way, by_arm, own, width, *into)
            _add_motion(way, joint, force, width, sums, pulls)
        cost[run] = _over(costs, 0)
        _gathered(sums, pulls, owns, information[run], gradient[run])
    return information, gradient, cost


@compiled
def points_shown(states: Array, camera: tuple[Array, float], rows: IntArray) -> Array:
    """Return what the cameras show of the points at all epochs, (run, epoch, N r)."""
    (runs, epochs), points = states.shape[:2], (states.shape[2] - 15) // 3
    each = len(rows)
    result, body = np.empty((runs, epochs, points * each)), np.empty(18 * LANES)
    arm, view, shown = np.empty(3 * LANES), np.empty(8 * LANES), np.empty(9 * LANES)
    for run in range(runs):
        for first in range(0, epochs, LANES):
            count = min(LANES, epochs - first)
            width = 8 * ((count + 7) // 8)
            _gather(states[run], camera[0], first, count, width, body)
            for i in range(points):
                place = states[run, first, 15 + 3 * i : 18 + 3 * i]
                shown_of(body, place, camera[1], width, arm, view, shown)
                for k in range(count):
                    for r in range(each):
                        result[run, first + k, each * i + r] = shown[LANES * rows[r] + k]
    return result


@compiled
def _gather(states: Array, axes: Array, first: int, count: int, width: int, body: Array) -> None:
    """Write the body's lanes (`lane_loops`) of some epochs; those without one have the last."""
    q = np.empty(4 * LANES)
    for k in range(width):
        epoch = first + min(k, count - 1)
        for c in range(9):
            body[LANES * c + k] = states[epoch, c]
        for c in range(4):
            q[LANES * c + k] = states[epoch, 9 + c]
    for k in range(width):
        w, x, y, z = q[k], q[LANES + k], q[2 * LANES + k], q[3 * LANES + k]
        body[9 * LANES + k], body[10 * LANES + k] = (
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y + w * z),
        )
        body[11 * LANES + k], body[12 * LANES + k] = 2.0 * (x * z - w * y), 2.0 * (x * y - w * z)
        body[13 * LANES + k], body[14 * LANES + k] = (
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z + w * x),
        )
        body[15 * LANES + k], body[16 * LANES + k] = 2.0 * (x * z + w * y), 2.0 * (y * z - w * x)
        body[17 * LANES + k] = 1.0 - 2.0 * (x * x + y * y)
    for c in range(0, 18, 3):
        _turn(axes, body, c, width)


@compiled
def _gather_ways(
    turning: Array, centre: Array, axes: Array, first: int, count: int, width: int, way: Array
) -> None:
    """Write the ways (84) of some epochs from the start: ``centre`` and ``turning``, by columns."""
    for k in range(width):
        for c in range(6):
            for a in range(8):
                epoch = first + min(k, count - 1)
                way[LANES * (_TURNS + 6 * a + c) + k] = turning[epoch, c, a]
    for a in range(6):
        for c in range(6):
            for k in range(width):
                way[LANES * (6 * a + c) + k] = centre[a, c, first + k]
    for c in range(_TURNS, 84, 3):
        _turn(axes, way, c, width)


@compiled
def _turn(axes: Array, lanes: Array, of: int, width: int) -> None:
    """Turn vectors in place."""
    o = LANES * of
    for k in range(width):
        x, y, z = lanes[o + k], lanes[o + LANES + k], lanes[o + 2 * LANES + k]
        lanes[o + k] = axes[0, 0] * x + axes[0, 1] * y + axes[0, 2] * z
        lanes[o + LANES + k] = axes[1, 0] * x + axes[1, 1] * y + axes[1, 2] * z
        lanes[o + 2 * LANES + k] = axes[2, 0] * x + axes[2, 1] * y + axes[2, 2] * z


@compiled
def _add_point(
    way: Array, told: Array, own: Array, width: int, sums: Array, pulls: Array, owns: Array
) -> None:
    """Add what a point in the body tells together with the motion at the start, and by itself.

    ``sums (3, 14)``, ``pulls (3)``, ``owns (3, 3)``.
    """
    turns = way[_TURNS * LANES :]
    for b in range(3):
        with_centre, with_turn = told[15 * b * LANES :], told[(15 * b + 6) * LANES :]
        add_six(way, with_centre, width, sums[14 * b * LANES :])
        add_six(turns, with_turn, width, sums[(14 * b + 6) * LANES :])
        add_two(turns[36 * LANES :], with_turn, width, sums[(14 * b + 12) * LANES :])
        for k in range(width):
            pulls[LANES * b + k] += own[LANES * b + k]
        for a in range(3):
            o, i = LANES * (3 * b + a), LANES * (15 * b + 12 + a)
            for k in range(width):
                owns[o + k] += told[i + k]


@compiled
def _add_motion(
    way: Array, joint: Array, force: Array, width: int, sums: Array, pulls: Array
) -> None:
    """Add what epochs tell of their motion, ``joint (3, 6, 6)`` and ``force (12)``, at the start.

    ``sums (14, 14)``, of which what the rotation tells with the centre is left out, ``pulls (14)``.
    """
    turns, moved = way[_TURNS * LANES :], np.empty(12 * LANES)
    add_six(way, force, width, pulls)
    add_six(turns, force[6 * LANES :], width, pulls[6 * LANES :])
    add_two(turns[36 * LANES :], force[6 * LANES :], width, pulls[12 * LANES :])
    for a in range(14):
        fill(0.0, moved)
        own = way[6 * a * LANES :]
        if a < 6:
            add_six(joint, own, width, moved)
            add_six(joint[36 * LANES :], own, width, moved[6 * LANES :])
            add_six(way, moved, width, sums[14 * a * LANES :])
        else:
            add_six(joint[72 * LANES :], own, width, moved[6 * LANES :])
        add_six(turns, moved[6 * LANES :], width, sums[(14 * a + 6) * LANES :])
        add_two(turns[36 * LANES :], moved[6 * LANES :], width, sums[(14 * a + 12) * LANES :])


@compiled
def _gathered(sums: Array, pulls: Array, owns: Array, information: Array, gradient: Array) -> None:
    """Write the sums over all lanes."""
    n_e = len(gradient)
    for b in range(n_e):
        gradient[b] = _over(pulls, b)
        for a in range(min(b + 1, 14)):
            information[a, b] = _over(sums, 14 * a + b if b < 14 else 14 * b + a)
            information[b, a] = information[a, b]
    for i in range(0, n_e - 14, 3):
        for a in range(3):
            for b in range(3):
                information[14 + i + a, 14 + i + b] = _over(owns, 3 * (i + b) + a)


@compiled
def _over(lanes: Array, number: int) -> float:
    total = 0.0
    for k in range(LANES * number, LANES * (number + 1)):
        total += lanes[k]
    return total
