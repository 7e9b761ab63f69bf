"""Motion relative to a leader as plain loops, for `debrisest.compiled`.

Equations and scheme are those of `relative_orbit`, where their words are. Runs lie side by side.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled

_LANES = 32
_Y, _Z, _U, _V, _W = (_LANES * c for c in range(1, 6))
_PARTS, _WEIGHTS = (0.5, 0.5, 1.0, 0.0), (1.0, 2.0, 2.0, 1.0)


@compiled
def translations(start: Array, leader: Array, steps: Array, mu: float) -> Array:
    """Return position and velocity (run, step + 1, 6) from ``start (run, 6)`` on.

    ``leader (2 step + 1, 3)`` is its radius, rate and acceleration at the ends and middles of the
    ``steps (step,)``, which may be negative.
    """
    moved = np.empty((len(start), len(steps) + 1, 6))
    x, at, slope = np.zeros(6 * _LANES), np.zeros(6 * _LANES), np.empty(6 * _LANES)
    for first in range(0, len(start), _LANES):
        runs = min(_LANES, len(start) - first)
        for c in range(6):
            for r in range(runs):
                x[_LANES * c + r] = start[first + r, c]
        for k in range(len(steps) + 1):
            for r in range(runs):
                for c in range(6):
                    moved[first + r, k, c] = x[_LANES * c + r]
            if k < len(steps):
                _step(x, leader[2 * k : 2 * k + 3], steps[k], mu, at, slope)
    return moved


@compiled
def _step(x: Array, leader: Array, step: float, mu: float, at: Array, slope: Array) -> None:
    """Move all lanes by a step; ``at`` and ``slope`` (6) are for use in between."""
    at[:] = x
    total = x.copy()
    for i in range(4):
        _slopes(at, leader[(i + 1) // 2], mu, slope)
        for r in range(6 * _LANES):
            total[r] += _WEIGHTS[i] * step / 6.0 * slope[r]
            at[r] = x[r] + _PARTS[i] * step * slope[r]
    x[:] = total


@compiled
def _slopes(state: Array, leader: Array, mu: float, slope: Array) -> None:
    radius, rate, acceleration = leader[0], leader[1], leader[2]
    free = mu / radius**2
    for r in range(_LANES):
        x, y, z = state[r], state[_Y + r], state[_Z + r]
        u, v, w = state[_U + r], state[_V + r], state[_W + r]
        far = (radius + x) ** 2 + y * y + z * z
        pull, square = mu / (far * np.sqrt(far)), rate * rate
        slope[r], slope[_Y + r], slope[_Z + r] = u, v, w
        slope[_U + r] = (2.0 * rate * v + acceleration * y + square * x) + (
            free - pull * (radius + x)
        )
        slope[_V + r] = -2.0 * rate * u - acceleration * x + (square - pull) * y
        slope[_W + r] = -pull * z
