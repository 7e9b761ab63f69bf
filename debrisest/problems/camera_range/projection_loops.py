"""What a camera shows of cores and points, with derivatives, as plain loops.

The formulas are those of `projection.rows`, where their words are.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled


@compiled
def pixels(
    cores: Array,
    points: Array,
    to_camera: Array,
    by_position: Array,
    optics: tuple[float, float],
    implied: bool,
    biased: bool,
    wide: tuple[int, int],
) -> tuple[Array, Array, Array, Array]:
    """Return pixels (run, epoch, N, 2), and their derivatives by errors, by points and by a bias.

    Of cores ``(run, epoch, n)``, points ``(run, N, 3)`` and ``R_ch (run, epoch, 3, 3)``. A camera
    whose attitude is ``implied`` turns by the position as ``by_position (run, epoch, 3, 3)`` has
    it. ``optics`` are the focal length, px, and the least depth. With a camera that is ``biased``
    the last three errors are its bias. How ``wide`` the derivatives by errors and by the bias are:
    the latter are 3, or not wanted.
    """
    runs, epochs, count = *cores.shape[:2], points.shape[1]
    shown, by_point = np.empty((runs, epochs, count, 2)), np.empty((runs, epochs, count, 2, 3))
    by_core = np.zeros((runs, epochs, count, 2, wide[0]))
    by_bias = np.empty((runs, epochs, count, 2, wide[1]))
    turn, shift = np.empty((3, 3)), np.empty((3, 3))
    for run in range(runs):
        for k in range(epochs):
            _turned(cores[run, k], to_camera[run, k], turn)
            slopes = by_core[run, k], by_point[run, k], by_bias[run, k]
            frame = (cores[run, k], to_camera[run, k], by_position[run, k])
            _frame(frame, points[run], turn, shift, optics, implied, biased, shown[run, k], slopes)
    return shown, by_core, by_point, by_bias


@compiled
def _turned(core: Array, away: Array, turn: Array) -> None:
    """Write the rotation (3, 3) from body axes to the camera's."""
    w, x, y, z = core[0], core[1], core[2], core[3]
    for i in range(3):
        a, b, c = away[i, 0], away[i, 1], away[i, 2]
        turn[i, 0] = a * (1.0 - 2.0 * (y * y + z * z)) + b * 2.0 * (x * y + w * z)
        turn[i, 0] += c * 2.0 * (x * z - w * y)
        turn[i, 1] = a * 2.0 * (x * y - w * z) + b * (1.0 - 2.0 * (x * x + z * z))
        turn[i, 1] += c * 2.0 * (y * z + w * x)
        turn[i, 2] = a * 2.0 * (x * z + w * y) + b * 2.0 * (y * z - w * x)
        turn[i, 2] += c * (1.0 - 2.0 * (x * x + y * y))


@compiled
def _frame(
    frame: tuple[Array, Array, Array],
    points: Array,
    turn: Array,
    shift: Array,
    optics: tuple[float, float],
    implied: bool,
    biased: bool,
    shown: Array,
    slopes: tuple[Array, Array, Array],
) -> None:
    """Write pixels (N, 2) of a frame and their derivatives (N, 2, .)."""
    core, away, by_position = frame
    by_core, by_point, by_bias = slopes
    u, v, w = core[7], core[8], core[9]
    for i in range(3):
        for j in range(3):
            shift[i, j] = -away[i, j]
    for n in range(len(points)):
        a, b, c = points[n, 0], points[n, 1], points[n, 2]
        x = turn[0, 0] * a + turn[0, 1] * b + turn[0, 2] * c
        y = turn[1, 0] * a + turn[1, 1] * b + turn[1, 2] * c
        z = turn[2, 0] * a + turn[2, 1] * b + turn[2, 2] * c
        if implied:
            _turning(by_position, core, (x, y, z), shift)
        x -= away[0, 0] * u + away[0, 1] * v + away[0, 2] * w
        y -= away[1, 0] * u + away[1, 1] * v + away[1, 2] * w
        z -= away[2, 0] * u + away[2, 1] * v + away[2, 2] * w
        z = optics[1] if z < optics[1] else z
        scale = optics[0] / z
        for i in range(2):
            ratio = (y if i else x) / z
            shown[n, i] = optics[0] * ratio
            for j in range(3):
                by_point[n, i, j] = scale * (turn[i, j] - ratio * turn[2, j])
                by_core[n, i, 3 + j] = scale * (shift[i, j] - ratio * shift[2, j])
            by_core[n, i, 0] = b * by_point[n, i, 2] - c * by_point[n, i, 1]
            by_core[n, i, 1] = c * by_point[n, i, 0] - a * by_point[n, i, 2]
            by_core[n, i, 2] = a * by_point[n, i, 1] - b * by_point[n, i, 0]
            if by_bias.shape[2]:
                by_bias[n, i, 0] = scale * (ratio * y + (z if i else 0.0))
                by_bias[n, i, 1] = -scale * (ratio * x + (0.0 if i else z))
                by_bias[n, i, 2] = scale * (-x if i else y)
            if biased:
                for j in range(3):
                    by_core[n, i, by_core.shape[2] - 3 + j] = by_bias[n, i, j]


@compiled
def _turning(by: Array, core: Array, arm: tuple[float, float, float], shift: Array) -> None:
    """Write the derivative (3, 3) of a point by the position that its camera looks from."""
    x, y, z = arm
    distance = np.sqrt(core[7] ** 2 + core[8] ** 2 + core[9] ** 2)
    for j in range(3):
        shift[0, j] = y * by[2, j] - z * by[1, j]
        shift[1, j] = z * by[0, j] - x * by[2, j]
        shift[2, j] = x * by[1, j] - y * by[0, j] + core[7 + j] / distance
