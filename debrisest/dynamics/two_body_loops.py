"""A step of two-body motion and its derivative, for compiled loops, as in `perturbed_orbit`."""

import math

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def advance(state: Array, step: float, mu: float, scratch: Array) -> None:
    """Replace position and velocity (6,) by those a step later; ``scratch (3, 6)``."""
    now, slope, total = scratch
    now[:], total[:] = state, 0.0
    for i in range(4):
        square = now[0] * now[0] + now[1] * now[1] + now[2] * now[2]
        pull = -mu / (square * math.sqrt(square))
        for a in range(3):
            slope[a], slope[3 + a] = now[3 + a], pull * now[a]
        reach = 0.5 * step if i < 2 else step
        weight = 2.0 if i == 1 or i == 2 else 1.0
        for a in range(6):
            total[a] += weight * slope[a]
            now[a] = state[a] + reach * slope[a]
    for a in range(6):
        state[a] += step / 6.0 * total[a]


@compiled
def transition(state: Array, step: float, mu: float, by: Array, gradient: Array) -> None:
    """Write the derivative (6, 6) of a step; ``gradient (3, 3)`` is written too."""
    x, y, z = (
        state[0] + 0.5 * step * state[3],
        state[1] + 0.5 * step * state[4],
        state[2] + 0.5 * step * state[5],
    )
    square = x * x + y * y + z * z
    size, middle = mu / (square * math.sqrt(square)), (x, y, z)
    for i in range(3):
        for j in range(3):
            gradient[i, j] = size * 3.0 / square * middle[i] * middle[j]
        gradient[i, i] -= size
    half, sixth = 0.5 * step**2, step**3 / 6.0
    for i in range(3):
        for j in range(3):
            bent = 0.0
            for k in range(3):
                bent += gradient[i, k] * gradient[k, j]
            same = 1.0 if i == j else 0.0
            by[i, j] = by[3 + i, 3 + j] = same + half * gradient[i, j]
            by[i, 3 + j] = step * same + sixth * gradient[i, j]
            by[3 + i, j] = step * gradient[i, j] + sixth * bent
