"""The angular acceleration that is measured, of one run, for compiled loops."""

import math

from debrisest.arrays import Array
from debrisest.attitude.vector_loops import applied, applied_back, cross
from debrisest.compiled import compiled
from debrisest.dynamics.inertia_ratios_loops import slopes


@compiled
def acceleration_rows(state: Array, turn: Array, spin: float, shown: Array, rows: Array) -> None:
    """Write what is shown (3,), and its derivative (3, 8) by rate, attitude and ratios.

    ``turn (3, 3)`` are the state's axes, ``spin`` is the leader's rate.
    """
    whole = state[6], state[7], state[8] + spin
    x, y, z = applied_back(turn, whole)
    sx, sy, sz = slopes(state[13], state[14])
    e1, e2 = math.exp(state[13]), math.exp(state[14])
    products, slope = (y * z, z * x, x * y), (sx, sy, sz)
    by_rate = (0.0, sx * z, sx * y), (sy * z, 0.0, sy * x), (sz * y, sz * x, 0.0)
    by_ratios = (-sx, 1.0 / (e1 * e2)), (-e1, -1.0 / e2), (e1 * e2, sz)
    for i in range(3):
        shown[i] = slope[i] * products[i]
        of_rate = applied(turn, by_rate[i])
        of_turn = cross(of_rate, whole)
        for j in range(3):
            rows[i, j], rows[i, 3 + j] = of_rate[j], of_turn[j]
        for j in range(2):
            rows[i, 6 + j] = products[i] * by_ratios[i][j]
