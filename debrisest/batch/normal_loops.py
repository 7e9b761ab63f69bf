"""Normal equations of an arc on known points, with derivatives by differences, as plain loops.

Epochs go in blocks whose numbers are vectors: what an epoch says stands in the last axis.
"""

import numpy as np

from debrisest.array_loops import copy, fill, fill_rows
from debrisest.arrays import Array
from debrisest.attitude.rotation_loops import Quaternion, Vector, inner, rows_of
from debrisest.compiled import compiled, compiled_sum

Work = tuple[Array, Array, Array]
"""Room for a block: derivatives, information times these (11, 3, epoch), and pull (3, epoch)."""
_BLOCK = 64


@compiled
def room() -> Work:
    """Return room for a block of epochs."""
    return np.zeros((11, 3, _BLOCK)), np.zeros((11, 3, _BLOCK)), np.zeros((3, _BLOCK))


@compiled
def normal(
    q: Array, step: Array, told: tuple[Array, Array], work: Work, pull: Array, information: Array
) -> float:
    """Write pull (11) and information (11, 11), and return the sum of ``tr(R^T B)``.

    ``q (9, 4, time)`` are the attitudes of the arc and of eight beside it, a ``step (8)`` away;
    ``told`` are the first two of the sums of known points, (9, time) and (6, time).
    """
    by, turned, push = work
    fit, times = 0.0, q.shape[2]
    fill(0.0, pull)
    fill_rows(0.0, information)
    for i in range(3):
        for j in range(3):
            fill(1.0 if i == j else 0.0, by[i, j])
    for first in range(0, times, _BLOCK):
        count = min(_BLOCK, times - first)
        _derivatives(q, first, count, step, by)
        fit += _weighed(q[0], first, count, told, work)
        for a in range(11):
            pull[a] += _product(by[a], push)
            for b in range(a + 1):
                information[a, b] += _product(by[a], turned[b])
    for a in range(11):
        for b in range(a):
            information[b, a] = information[a, b]
    return fit


@compiled_sum
def fit(q: Array, product: Array) -> float:
    """Return the sum of ``tr(R^T B)`` over attitudes (4, time), ``product (9, time)``."""
    total = 0.0
    for t in range(q.shape[1]):
        r, s, u = rows_of(at(q, t))
        x, y, z = _three(product, 0, t), _three(product, 3, t), _three(product, 6, t)
        total += inner(x, r) + inner(y, s) + inner(z, u)
    return total


@compiled_sum
def _product(one: Array, other: Array) -> float:
    total = 0.0
    for i in range(3):
        for k in range(_BLOCK):
            total += one[i, k] * other[i, k]
    return total


@compiled
def _derivatives(q: Array, first: int, count: int, step: Array, by: Array) -> None:
    """Write those of the turn by rate and inertia."""
    for k in range(8):
        x_by, y_by, z_by, own, beside = by[3 + k, 0], by[3 + k, 1], by[3 + k, 2], q[0], q[k + 1]
        for t in range(count):
            a, b, c, d = at(own, first + t)
            w, x, y, z = at(beside, first + t)
            per = 2.0 / (step[k] * (w * a + x * b + y * c + z * d))
            x_by[t] = per * (-w * b + x * a - y * d + z * c)
            y_by[t] = per * (-w * c + x * d + y * a - z * b)
            z_by[t] = per * (-w * d - x * c + y * b + z * a)


@compiled
def _weighed(q: Array, first: int, count: int, told: tuple[Array, Array], work: Work) -> float:
    """Write pull, and information times derivatives, which are zero behind the last epoch."""
    by, turned, push = work
    fits, total = np.empty(count), 0.0
    for i in range(3):
        fill(0.0, push[i, count:])
        for k in range(11):
            fill(0.0, turned[k, i, count:])
    hold = turned[0, 0], turned[0, 1], turned[0, 2], turned[1, 1], turned[1, 2], turned[2, 2]
    for t in range(count):
        fits[t], pulled, ((a, b, c), (d, e, f)) = said(told, rows_of(at(q, first + t)), first + t)
        push[0, t], push[1, t], push[2, t] = pulled
        hold[0][t], hold[1][t], hold[2][t], hold[3][t], hold[4][t], hold[5][t] = a, b, c, d, e, f
    for i in range(3):
        for k in range(i):
            copy(turned[k, i], turned[i, k])
    for k in range(3, 11):
        one, other = by[k], turned[k]
        for t in range(count):
            row = one[0, t], one[1, t], one[2, t]
            other[0, t] = inner((hold[0][t], hold[1][t], hold[2][t]), row)
            other[1, t] = inner((hold[1][t], hold[3][t], hold[4][t]), row)
            other[2, t] = inner((hold[2][t], hold[4][t], hold[5][t]), row)
    for t in range(count):
        total += fits[t]
    return total


@compiled
def said(
    told: tuple[Array, Array], rows: tuple[Vector, Vector, Vector], t: int
) -> tuple[float, Vector, tuple[Vector, Vector]]:
    """Return ``tr(R^T B)``, pull and information, its upper triangle row by row, of an epoch."""
    x, y, z = _three(told[0], 0, t), _three(told[0], 3, t), _three(told[0], 6, t)
    r, s, u = rows
    spread = _three(told[1], 0, t), _three(told[1], 3, t)
    a, b, c = _held(spread, r), _held(spread, s), _held(spread, u)
    pull = inner(z, s) - inner(y, u), inner(x, u) - inner(z, r), inner(y, r) - inner(x, s)
    upper = (inner(r, a), inner(r, b), inner(r, c)), (inner(s, b), inner(s, c), inner(u, c))
    return inner(x, r) + inner(y, s) + inner(z, u), pull, upper


@compiled
def at(q: Array, t: int) -> Quaternion:
    """Return one of attitudes (4, time)."""
    return q[0, t], q[1, t], q[2, t], q[3, t]


@compiled
def _three(told: Array, k: int, t: int) -> Vector:
    return told[k, t], told[k + 1, t], told[k + 2, t]


@compiled
def _held(spread: tuple[Vector, Vector], row: Vector) -> Vector:
    """A symmetric matrix, its upper triangle row by row, times a vector."""
    (a, b, c), (d, e, f) = spread
    return inner((a, b, c), row), inner((b, d, e), row), inner((c, e, f), row)
