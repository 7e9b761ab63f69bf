"""Arcs relative to a leader's axes as plain loops, for `debrisest.compiled`.

Equations are those of `relative_arc`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.rotation_loops import matrix_of
from debrisest.compiled import compiled


@compiled
def relative(
    q_ib: Array,
    rate_b: Array,
    by_start: tuple[Array, Array],
    to_start: Array,
    leader: Array,
) -> tuple[Array, Array, Array]:
    """Return ``q_lt (run, time, 4)``, rates (run, time, 3) and sensitivities (run, time, 6, 8).

    Of a `torque_free_sensitivity.Arc`; ``to_start (run, 5, 8)`` are its start and ratios by those
    in the leader's axes, ``leader (time, 3)`` the cosine and sine of half its turn, and its rate.
    """
    runs, times = q_ib.shape[:2]
    q, rate = np.empty((runs, times, 4)), np.empty((runs, times, 3))
    sensitivity, whole = np.empty((runs, times, 6, 8)), np.empty(3)
    for run in range(runs):
        for t in range(times):
            c, s, spin = leader[t]
            w, x, y, z = q_ib[run, t]
            q[run, t, 0], q[run, t, 1] = c * w + s * z, c * x + s * y
            q[run, t, 2], q[run, t, 3] = c * y - s * x, c * z - s * w
            turn, found = matrix_of(q[run, t]), sensitivity[run, t]
            x, y, z = rate_b[run, t]
            for i in range(3):
                whole[i] = turn[i, 0] * x + turn[i, 1] * y + turn[i, 2] * z
            rate[run, t, 0], rate[run, t, 1], rate[run, t, 2] = whole[0], whole[1], whole[2] - spin
            cos, sin = c * c - s * s, 2.0 * c * s
            for b in range(8):
                u, v, w = _column(by_start[0][run, t], to_start[run], b)
                u += 1.0 if b == 3 else 0.0
                v += 1.0 if b == 4 else 0.0
                w += 1.0 if b == 5 else 0.0
                u, v = cos * u + sin * v, cos * v - sin * u
                found[3, b], found[4, b], found[5, b] = u, v, w
                x, y, z = _column(by_start[1][run, t], to_start[run], b)
                for i in range(3):
                    found[i, b] = turn[i, 0] * x + turn[i, 1] * y + turn[i, 2] * z
                found[0, b] -= whole[1] * w - whole[2] * v
                found[1, b] -= whole[2] * u - whole[0] * w
                found[2, b] -= whole[0] * v - whole[1] * u
    return q, rate, sensitivity


@compiled
def _column(by: Array, start: Array, b: int) -> tuple[float, float, float]:
    x = y = z = 0.0
    for a in range(5):
        x += by[0, a] * start[a, b]
        y += by[1, a] * start[a, b]
        z += by[2, a] * start[a, b]
    return x, y, z
