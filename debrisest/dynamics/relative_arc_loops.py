"""Arcs relative to a leader's axes as plain loops, for `debrisest.compiled`.

Equations are those of `relative_arc`, where their words are; epochs lie side by side, as in
`torque_free_sensitivity_loops`.
"""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude.vector_loops import Vector
from debrisest.compiled import compiled
from debrisest.dynamics.torque_free_sensitivity_loops import (
    LANES,
    chain,
    derivatives,
    ends_and_middles,
    motion,
)

_Y, _Z, _U, _V, _W = (LANES * c for c in range(1, 6))


@compiled
def relative(
    times: Array,
    start: tuple[Array, Array],
    body: tuple[Array, Array, Array],
    count: IntArray,
    to_start: Array,
    leader: Array,
) -> tuple[Array, Array, Array]:
    """Return ``q_lt (run, time, 4)``, rates (run, time, 3) and sensitivities (run, time, 6, 8).

    ``start`` is attitude (run, 4) and rate (run, 3) in the body; a body its moments (run, 3),
    slopes (run, 3) and the derivatives (run, 3, 2) of its acceleration by the ratios over the
    products of rates; ``count (run,)`` the parts of a step. ``to_start (run, 5, 8)`` are start and
    ratios by those in the leader's axes, ``leader (time, 3)`` the cosine and sine of half its turn,
    and its rate.
    """
    runs, epochs = len(count), len(times)
    q, rate = np.empty((runs, epochs, 4)), np.empty((runs, epochs, 3))
    sensitivity = np.empty((runs, epochs, 6, 8))
    steps, told = np.empty(30 * LANES), np.zeros(30 * LANES)
    by, turned = np.empty((3, 5)), np.empty((3, 5))
    for run in range(runs):
        parts = count[run]
        fine = ends_and_middles(times, parts)
        q_f, rate_f = motion(fine, start[0][run], start[1][run], body[0][run])
        by[:], turned[:] = np.eye(3, 5), 0.0
        for t in range(epochs):
            k = t % LANES
            for a in range(3):
                for b in range(5):
                    told[LANES * (3 * b + a) + k] = by[a, b]
                    told[LANES * (15 + 3 * b + a) + k] = turned[a, b]
            if k == LANES - 1 or t == epochs - 1:
                ends = q_f[:, parts * (t - k) :: parts], rate_f[:, parts * (t - k) :: parts]
                some = slice(t - k, t + 1)
                found = q[run, some], rate[run, some], sensitivity[run, some]
                _seen(*ends, leader[some], told, to_start[run], *found)
            for i in range(parts * t, parts * (t + 1) * (t < epochs - 1)):
                if i % LANES == 0:
                    derivatives(fine, q_f, rate_f, i, body[1][run], body[2][run], steps)
                chain(steps, i % LANES, by, turned)
    return q, rate, sensitivity


@compiled
def _seen(
    q_ib: Array,
    rate_b: Array,
    leader: Array,
    told: Array,
    to_start: Array,
    q: Array,
    rate: Array,
    sensitivity: Array,
) -> None:
    """Write what is seen from the leader at some epochs, whose derivatives are ``told``."""
    count, width = len(q), 8 * ((len(q) + 7) // 8)
    turn, whole, found = np.zeros(9 * LANES), np.zeros(3 * LANES), np.empty(6 * LANES)
    axes = np.zeros(2 * LANES)
    for k in range(count):
        c, s = leader[k, 0], leader[k, 1]
        axes[k], axes[_Y + k] = c * c - s * s, 2.0 * c * s
        of = _turned(q_ib[:, k], rate_b[:, k], leader[k], q[k], rate[k])
        for i in range(3):
            for j in range(3):
                turn[LANES * (3 * i + j) + k] = of[i][j]
            whole[LANES * i + k] = rate[k, i] + (leader[k, 2] if i == 2 else 0.0)
    for b in range(8):
        by = to_start[0, b], to_start[1, b], to_start[2, b], to_start[3, b], to_start[4, b]
        own = 1.0 * (b == 3), 1.0 * (b == 4), 1.0 * (b == 5)
        _column(told, by, own, axes, turn, whole, width, found)
        for c in range(6):
            for k in range(count):
                sensitivity[k, c, b] = found[LANES * c + k]


@compiled
def motion_seen(
    times: Array, start: tuple[Array, Array], moments: Array, leader: Array
) -> tuple[Array, Array]:
    """Return attitudes and rates as `relative`, without derivatives."""
    runs, epochs = len(moments), len(times)
    q, rate = np.empty((runs, epochs, 4)), np.empty((runs, epochs, 3))
    for run in range(runs):
        q_ib, rate_b = motion(times - times[0], start[0][run], start[1][run], moments[run])
        for t in range(epochs):
            _turned(q_ib[:, t], rate_b[:, t], leader[t], q[run, t], rate[run, t])
    return q, rate


@compiled
def _turned(
    q_ib: Array, rate_b: Array, leader: Array, q: Array, rate: Array
) -> tuple[Vector, Vector, Vector]:
    """Write attitude and rate that are seen from the leader; return the axes of that attitude."""
    c, s = leader[0], leader[1]
    w, x, y, z = q_ib[0], q_ib[1], q_ib[2], q_ib[3]
    w, x, y, z = c * w + s * z, c * x + s * y, c * y - s * x, c * z - s * w
    q[0], q[1], q[2], q[3] = w, x, y, z
    turn = (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )
    for i in range(3):
        rate[i] = turn[i][0] * rate_b[0] + turn[i][1] * rate_b[1] + turn[i][2] * rate_b[2]
    rate[2] -= leader[2]
    return turn


@compiled
def _column(
    told: Array,
    by: tuple[float, float, float, float, float],
    own: tuple[float, float, float],
    axes: Array,
    turn: Array,
    whole: Array,
    width: int,
    found: Array,
) -> None:
    """Write the derivative (6) of rate and attitude by one number at the start."""
    for k in range(width):
        u = own[0] + _sum(told, 15 * LANES + k, by)
        v = own[1] + _sum(told, 16 * LANES + k, by)
        w = own[2] + _sum(told, 17 * LANES + k, by)
        u, v = axes[k] * u + axes[_Y + k] * v, axes[k] * v - axes[_Y + k] * u
        x, y, z = _sum(told, k, by), _sum(told, _Y + k, by), _sum(told, _Z + k, by)
        p, q, r = whole[k], whole[_Y + k], whole[_Z + k]
        found[_U + k], found[_V + k], found[_W + k] = u, v, w
        a, b, c = turn[k], turn[_Y + k], turn[_Z + k]
        found[k] = a * x + b * y + c * z - (q * w - r * v)
        a, b, c = turn[_U + k], turn[_V + k], turn[_W + k]
        found[_Y + k] = a * x + b * y + c * z - (r * u - p * w)
        a, b, c = turn[6 * LANES + k], turn[7 * LANES + k], turn[8 * LANES + k]
        found[_Z + k] = a * x + b * y + c * z - (p * v - q * u)


@compiled
def _sum(told: Array, k: int, by: tuple[float, float, float, float, float]) -> float:
    total: float = by[0] * told[k] + by[1] * told[_U + k] + by[2] * told[6 * LANES + k]
    total += by[3] * told[9 * LANES + k] + by[4] * told[12 * LANES + k]
    return total
