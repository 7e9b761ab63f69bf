"""Prediction and iterated update of the replay filter by a frame, as plain loops.

Equations are those of `filters/replay/frame_update.py`, of `replay.point_rows` and of `chart`. In a
state's own chart the place of a point is an error itself, and its velocity depends on that of the
points' mean, on the rate and on the places alone. Sums are kept from their diagonal on.
"""

from typing import Any

import numpy as np

from debrisest.array_loops import copy, copy_rows, dot, fill, fill_rows
from debrisest.arrays import Array
from debrisest.attitude.vector_loops import Vector, cross, less, vector
from debrisest.compiled import compiled
from debrisest.filters.weights import GATE
from debrisest.linear_algebra_loops import factor, factor_inverse, factor_solve, mirror
from debrisest.problems.stereo_pose.acceleration_loops import acceleration_rows
from debrisest.problems.stereo_pose.chart_loops import difference, place, retract, to_plain
from debrisest.problems.stereo_pose.point_loops import add_row, rows_of_point

Camera = tuple[Any, ...]
"""Axes (3, 3) in the leader's, baseline, rows (r,) of `stereo.measure`, and the noise (m,). Where m
is more than N r the angular acceleration is the last of what is measured."""


@compiled
def updated(
    state: Array,
    information: Array,
    camera: Camera,
    spin: float,
    measured: Array,
    weight: Array,
    gate: bool,
    limits: tuple[int, float],
) -> Array:
    """Update predictions (run, n) and (run, n_e, n_e) in place by a frame; return the NIS (run,).

    ``spin`` is the leader's rate. What is ``measured (run, m)`` is normalised; with `gate` it takes
    weights (run, m) away. The limits are the most iterations, and the decrease of the cost that is
    promised below which they end.
    """
    (runs, n_e), points = information.shape[:2], (state.shape[1] - 15) // 3
    nis, total, work = np.empty(runs), np.empty((n_e, n_e)), np.empty((n_e, n_e))
    turn, arms, at_arms = np.empty((3, 3)), np.empty((points + 1, 3)), np.empty((points + 1, 3))
    offset, pull, step = np.empty(n_e), np.empty(n_e), np.empty(n_e)
    sums = np.empty((n_e - 8, n_e - 8)), np.empty(n_e - 8), np.empty((3, n_e - 8))
    for run in range(runs):
        own, at = information[run], state[run].copy()
        place(at, turn, arms)
        if gate:
            copy_rows(own, work)
            factor(work)
            factor_inverse(work, total)
            _judge(at, turn, arms, camera, spin, total, measured[run], weight[run])
        for _ in range(limits[0]):
            place(at, turn, at_arms)
            difference(state[run], arms, at, at_arms, offset)
            fill(0.0, pull)
            for a in range(n_e):
                for b in range(n_e):
                    pull[b] += offset[a] * own[a, b]
            copy_rows(own, total)
            copy(pull, step)
            seen = measured[run], weight[run]
            nis[run] = _add_frame(at, turn, at_arms, camera, spin, seen, sums, total, step)
            nis[run] += dot(offset, pull)
            copy(step, pull)
            copy_rows(total, work)
            factor(work)
            factor_solve(work, step)
            decrement = dot(step, pull)
            nis[run] -= decrement
            retract(at, step, turn, at_arms)
            if decrement < limits[1]:
                break
        mirror(total)
        copy_rows(total, own)
        copy(at, state[run])
    return nis


@compiled
def covariances(state: Array, information: Array) -> Array:
    """Return the plain covariances (run, n_e, n_e) of states and information in their charts."""
    (runs, n_e), points = information.shape[:2], (state.shape[1] - 15) // 3
    result, work = np.empty(information.shape), np.empty((n_e, n_e))
    turn, arms = np.empty((3, 3)), np.empty((points + 1, 3))
    for run in range(runs):
        place(state[run], turn, arms)
        rate, spread = vector(state[run, 6:]), result[run]
        copy_rows(information[run], spread)
        factor(spread)
        factor_inverse(spread, work)
        to_plain(rate, turn, arms, work)
        across(work, spread)
        to_plain(rate, turn, arms, spread)
        mirror(spread)
    return result


@compiled
def _add_frame(
    at: Array,
    turn: Array,
    arms: Array,
    camera: Camera,
    spin: float,
    seen: tuple[Array, Array],
    sums: tuple[Array, Array, Array],
    total: Array,
    right: Array,
) -> float:
    """Add what a frame tells in the state's own chart; return what it costs."""
    axes, baseline, rows, noise = camera
    measured, weight = seen
    joint, force, shared = sums
    shown, by = np.empty(len(rows)), np.zeros((len(rows), 6))
    square, push, mixed = np.empty((6, 6)), np.empty(6), np.empty((6, 6))
    fill_rows(0.0, joint)
    fill(0.0, force)
    cost, each = 0.0, len(rows)
    rate, points = vector(at[6:]), len(arms) - 1
    for i in range(points):
        rows_of_point(at, vector(arms[i]), (axes, baseline), rows, shown, by)
        fill_rows(0.0, square)
        fill(0.0, push)
        for r in range(each):
            m = each * i + r
            left = weight[m] * (measured[m] - shown[r] / noise[m])
            cost += left * left
            add_row(by[r], weight[m] / noise[m], left, 4 <= rows[r] < 8, square, push)
        mirror(square)
        beside = less(vector(arms[i]), vector(arms[points]))
        _add_point(square, push, beside, rate, 6 + 3 * i, mixed, joint, force)
    _share(rate, joint, force, shared, total, right)
    if len(noise) > each * points:
        cost += _add_acceleration(at, turn, spin, noise, seen, total, right)
    return cost


@compiled
def _add_point(
    square: Array,
    push: Array,
    beside: Vector,
    rate: Vector,
    first: int,
    mixed: Array,
    joint: Array,
    force: Array,
) -> None:
    """Add what place and velocity tell of what all points share, its velocity and the rate.

    ``beside`` is the point's place beside the points' mean. What they tell of the place itself is
    written, from ``first`` on. ``mixed (6, 6)`` is for use in between.
    """
    for a in range(6):
        flow = square[a, 3], square[a, 4], square[a, 5]
        turned, spun = cross(flow, rate), cross(beside, flow)
        for j in range(3):
            mixed[a, j], mixed[a, 3 + j] = square[a, j] + turned[j], spun[j]
    for i in range(3):
        for j in range(3):
            joint[i, j] += square[3 + i, 3 + j]
            joint[i, 3 + j] += mixed[3 + i, 3 + j]
            joint[i, first + j] = mixed[3 + i, j]
    for j in range(3):
        flow = mixed[3, j], mixed[4, j], mixed[5, j]
        spun = cross(beside, (mixed[3, 3 + j], mixed[4, 3 + j], mixed[5, 3 + j]))
        own, turned = cross(beside, flow), cross(flow, rate)
        for i in range(3):
            joint[3 + i, 3 + j] += spun[i]
            joint[3 + i, first + j] = own[i]
            joint[first + i, first + j] = mixed[i, j] + turned[i]
    flow = push[3], push[4], push[5]
    turned, spun = cross(flow, rate), cross(beside, flow)
    for j in range(3):
        force[j] += flow[j]
        force[3 + j] += spun[j]
        force[first + j] = push[j] + turned[j]


@compiled
def _share(
    rate: Vector, joint: Array, force: Array, shared: Array, total: Array, right: Array
) -> None:
    """Add what all points tell, in the chart: the shared velocity is less what turns their mean."""
    n = len(force)
    per = 3.0 / (n - 6)
    x, y, z = per * rate[0], per * rate[1], per * rate[2]
    for b in range(n):
        u, v, w = joint[0, b], joint[1, b], joint[2, b]
        shared[0, b], shared[1, b], shared[2, b] = y * w - z * v, z * u - x * w, x * v - y * u
    for a in range(6):
        right[3 + a] += force[a]
        for b in range(a, 6):
            total[3 + a, 3 + b] += joint[a, b]
        for b in range(6, n):
            total[3 + a, 8 + b] += joint[a, b] + shared[b % 3, a]
    flow = cross((x, y, z), vector(force))
    for a in range(6, n):
        c = a % 3
        right[8 + a] += force[a] + flow[c]
        twice = cross((x, y, z), vector(shared[c]))
        for b in range(a, n):
            total[8 + a, 8 + b] += joint[a, b] + shared[c, b] + (shared[b % 3, a] + twice[b % 3])


@compiled
def _add_acceleration(
    at: Array,
    turn: Array,
    spin: float,
    noise: Array,
    seen: tuple[Array, Array],
    total: Array,
    right: Array,
) -> float:
    """Add what the angular acceleration tells; return what it costs."""
    rows, shown, cost = np.empty((3, 8)), np.empty(3), 0.0
    acceleration_rows(at, turn, spin, shown, rows)
    for i in range(3):
        m = len(noise) - 3 + i
        left = seen[1][m] * (seen[0][m] - shown[i] / noise[m])
        cost += left * left
        for a in range(8):
            scaled = rows[i, a] * seen[1][m] / noise[m]
            right[6 + a] += scaled * left
            for b in range(a, 8):
                total[6 + a, 6 + b] += scaled * rows[i, b] * seen[1][m] / noise[m]
    return cost


@compiled
def _judge(
    at: Array,
    turn: Array,
    arms: Array,
    camera: Camera,
    spin: float,
    spread: Array,
    measured: Array,
    weight: Array,
) -> None:
    """Take the weights (m,) of innovations away that are too unlikely, as `innovation_gate`."""
    axes, baseline, rows, noise = camera
    each, points = len(rows), len(arms) - 1
    shown, by, wide = np.empty(each), np.zeros((each, 6)), np.empty((6, 6))
    mean, flow = np.zeros((3, len(spread))), np.empty((3, len(spread)))
    for i in range(points):
        for c in range(3):
            for b in range(len(spread)):
                mean[c, b] += spread[14 + 3 * i + c, b] / points
    for i in range(points):
        rows_of_point(at, vector(arms[i]), (axes, baseline), rows, shown, by)
        _spread_of_point(at, arms, i, spread, mean, flow, wide)
        for r in range(each):
            m = each * i + r
            off, square = measured[m] - shown[r] / noise[m], quadratic(by[r], wide)
            if not off * off <= GATE**2 * (1.0 + square / noise[m] ** 2):
                weight[m] = 0.0
    if len(noise) > each * points:
        told, of, own = np.empty((3, 8)), np.empty(3), np.empty((8, 8))
        for a in range(8):
            copy(spread[6 + a, 6:14], own[a])
        acceleration_rows(at, turn, spin, of, told)
        for i in range(3):
            m = each * points + i
            off, square = measured[m] - of[i] / noise[m], quadratic(told[i], own)
            if not off * off <= GATE**2 * (1.0 + square / noise[m] ** 2):
                weight[m] = 0.0


@compiled
def _spread_of_point(
    at: Array, arms: Array, i: int, spread: Array, mean: Array, flow: Array, wide: Array
) -> None:
    """Write the covariance (6, 6) of place and velocity of a point.

    ``mean (3, n_e)`` is that of the points' mean with all errors, ``flow`` for use in between.
    """
    points = len(arms) - 1
    x, y, z = less(vector(arms[i]), vector(arms[points]))
    p, q, r = vector(at[6:])
    own = spread[14 + 3 * i : 17 + 3 * i]
    for b in range(len(spread)):
        u, v, w = spread[6, b], spread[7, b], spread[8, b]
        f, g, h = own[0, b] - mean[0, b], own[1, b] - mean[1, b], own[2, b] - mean[2, b]
        flow[0, b] = spread[3, b] + (v * z - w * y) + (q * h - r * g)
        flow[1, b] = spread[4, b] + (w * x - u * z) + (r * f - p * h)
        flow[2, b] = spread[5, b] + (u * y - v * x) + (p * g - q * f)
    for a in range(3):
        f = g = h = 0.0
        for j in range(points):
            f += flow[a, 14 + 3 * j] / points
            g += flow[a, 15 + 3 * j] / points
            h += flow[a, 16 + 3 * j] / points
        k = 14 + 3 * i
        turned = cross((p, q, r), (flow[a, k] - f, flow[a, k + 1] - g, flow[a, k + 2] - h))
        spun = cross((flow[a, 6], flow[a, 7], flow[a, 8]), (x, y, z))
        for b in range(3):
            wide[a, b] = own[a, k + b]
            wide[3 + a, b] = wide[b, 3 + a] = flow[a, k + b]
            wide[3 + a, 3 + b] = flow[a, 3 + b] + spun[b] + turned[b]


@compiled
def quadratic(row: Array, matrix: Array) -> float:
    """Return ``v^T M v``."""
    total = 0.0
    for a in range(len(row)):
        for b in range(len(row)):
            total += row[a] * matrix[a, b] * row[b]
    return total


@compiled
def across(matrix: Array, transposed: Array) -> None:
    """Write a matrix (n, n) transposed."""
    for a in range(len(matrix)):
        for b in range(len(matrix)):
            transposed[b, a] = matrix[a, b]
