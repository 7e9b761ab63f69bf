"""The model of an orbit that is seen from satellites as plain loops over runs and tracks.

For `debrisest.compiled`; the formulas are those of `model`, where their words are.
"""

import math

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.dynamics.kepler import MU_EARTH
from debrisest.dynamics.two_body_loops import advance, transition


@compiled
def both(states: Array, step: float) -> tuple[Array, Array]:
    """Return states (run, track, n) a step later, and the derivative (run, track, n, n)."""
    runs, tracks, n = states.shape
    moved, by = states.copy(), np.zeros((runs, tracks, n, n))
    scratch, gradient = np.empty((3, 6)), np.empty((3, 3))
    for r in range(runs):
        for t in range(tracks):
            transition(states[r, t], step, MU_EARTH, by[r, t], gradient)
            advance(moved[r, t, :6], step, MU_EARTH, scratch)
            for i in range(6, n):
                by[r, t, i, i] = 1.0
    return moved, by


@compiled
def all_seen(
    states: Array, observer: Array, to_camera: Array, scale: Array, doubts: int
) -> tuple[Array, Array, Array]:
    """Return pixels (run, track, observer, 2), their derivatives (..., 2, n), and by the doubts.

    ``observer (run, observer, 3)``, ``to_camera (run, observer, 3, 3)``, ``scale (run,)``. The
    last, (run, observer, 2, doubt), are the target's.
    """
    (runs, tracks, n), observers = states.shape, observer.shape[1]
    pixels = np.empty((runs, tracks, observers, 2))
    by = np.zeros((runs, tracks, observers, 2, n))
    by_doubt = np.zeros((runs, observers, 2, doubts))
    point, turn, left, slope = np.empty(3), np.empty((3, 3)), np.empty((3, 3)), np.empty((2, 3))
    for r in range(runs):
        for t in range(tracks):
            for s in range(observers):
                _turn(states[r, t], s, to_camera[r, s], turn, left)
                for a in range(3):
                    point[a] = 0.0
                    for i in range(3):
                        point[a] += turn[a, i] * (states[r, t, i] - observer[r, s, i])
                _see(point, turn, scale[r], pixels[r, t, s], by[r, t, s], slope)
                for a in range(2):
                    for i in range(3):
                        for j in range(3 if n > 6 else 0):
                            by[r, t, s, a, 6 + 3 * s + i] += slope[a, j] * left[j, i]
                        if n == 6 and t == 0 and point[2] > 0.0:
                            by_doubt[r, s, a, 1 + 3 * s + i] = slope[a, i]
                    if t == 0 and point[2] > 0.0:
                        by_doubt[r, s, a, 0] = pixels[r, t, s, a]
    return pixels, by, by_doubt


@compiled
def _see(point: Array, turn: Array, scale: float, pixel: Array, by: Array, slope: Array) -> None:
    """Write the pixel of a point, its derivative by the place, and by a turn of the camera.

    All is NaN of what is not in front of the camera.
    """
    size = scale / point[2] if point[2] > 0.0 else np.nan
    x, y = size * point[0] / scale, size * point[1] / scale
    pixel[0], pixel[1] = scale * x, scale * y
    for i in range(3):
        by[0, i] = size * (turn[0, i] - x * turn[2, i])
        by[1, i] = size * (turn[1, i] - y * turn[2, i])
    slope[0, 0], slope[0, 1], slope[0, 2] = -scale * x * y, scale * (1.0 + x * x), -scale * y
    slope[1, 0], slope[1, 1], slope[1, 2] = -scale * (1.0 + y * y), scale * x * y, scale * x


@compiled
def _turn(state: Array, s: int, to_camera: Array, turn: Array, left: Array) -> None:
    """Write the turn into camera axes, which may have an error, and the left Jacobian of that."""
    if len(state) == 6:
        for i in range(3):
            for j in range(3):
                turn[i, j] = to_camera[i, j]
        return
    bias = state[6 + 3 * s : 9 + 3 * s]
    x, y, z = bias[0], bias[1], bias[2]
    square = x * x + y * y + z * z
    angle = math.sqrt(square)
    sine = math.sin(angle) / angle if angle > 0.0 else 1.0
    versed = 2.0 * (math.sin(0.5 * angle) / angle) ** 2 if angle > 0.0 else 0.5
    cross, exact = ((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)), np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            same = 1.0 if i == j else 0.0
            twice = bias[i] * bias[j] - square * same
            exact[i, j] = same + sine * cross[i][j] + versed * twice
            left[i, j] = same + 0.5 * cross[i][j] + twice / 6.0
    for i in range(3):
        for j in range(3):
            turn[i, j] = 0.0
            for k in range(3):
                turn[i, j] += exact[i, k] * to_camera[k, j]
