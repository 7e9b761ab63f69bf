"""Motion relative to a leader as plain loops, for `debrisest.compiled`.

Equations and scheme are those of `relative_orbit`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

_PARTS, _WEIGHTS = (0.5, 0.5, 1.0, 0.0), (1.0, 2.0, 2.0, 1.0)


@compiled
def translations(start: Array, leader: Array, steps: Array, mu: float) -> Array:
    """Return position and velocity (run, step + 1, 6) from ``start (run, 6)`` on.

    ``leader (2 step + 1, 3)`` is its radius, rate and acceleration at the ends and middles of the
    ``steps (step,)``, which may be negative.
    """
    moved = np.empty((len(start), len(steps) + 1, 6))
    x, slope = np.empty(6), np.empty(6)
    for run in range(len(start)):
        moved[run, 0] = start[run]
        for k in range(len(steps)):
            x[:] = moved[run, k]
            moved[run, k + 1] = x
            for i in range(4):
                _slopes(x, leader[2 * k + (i + 1) // 2], mu, slope)
                for j in range(6):
                    moved[run, k + 1, j] += _WEIGHTS[i] * steps[k] / 6.0 * slope[j]
                    x[j] = moved[run, k, j] + _PARTS[i] * steps[k] * slope[j]
    return moved


@compiled
def _slopes(state: Array, leader: Array, mu: float, slope: Array) -> None:
    x, y, z, u, v, w = state
    radius, rate, acceleration = leader
    far = (radius + x) ** 2 + y * y + z * z
    pull, square = mu / (far * np.sqrt(far)), rate * rate
    slope[0], slope[1], slope[2] = u, v, w
    slope[3] = (2.0 * rate * v + acceleration * y + square * x) + (
        mu / radius**2 - pull * (radius + x)
    )
    slope[4] = -2.0 * rate * u - acceleration * x + (square - pull) * y
    slope[5] = -pull * z
