"""The step of `redundant_model` as plain loops over pairs of points, for `debrisest.compiled`."""

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.problems.camera_range.redundant_motion_loops import BODY, CORE, LANES, moved_core


@compiled
def moved_pairs(
    state: Array,
    columns: Array,
    scale: float,
    orbit: Array,
    pace: tuple[float, float],
    duration: float,
) -> Array:
    """Move states (run, n) and their columns (run, n, n) by one step; see `PairedSteps.move`.

    ``orbit (6, 6)`` is the transition of position and velocity, ``pace`` the mean motion and three
    times its square.
    """
    runs, n = state.shape
    loose = np.zeros((runs, 2 * CORE, n))
    core, new, turned = np.empty(CORE * LANES), np.empty(BODY * LANES), np.empty(10 * LANES)
    for run in range(runs):
        _drawn(state[run], columns[run], scale, core)
        moved_core(core, orbit, pace, duration, new, turned)
        _spread(state[run], columns[run], scale, new, turned, loose[run])
    return loose


@compiled
def _drawn(state: Array, columns: Array, scale: float, core: Array) -> None:
    """Write the core of all points."""
    for i in range(CORE):
        for t in range(LANES):
            core[i * LANES + t] = state[i]
        for j in range(CORE):
            core[i * LANES + 1 + j] += scale * columns[j, i]
            core[i * LANES + 1 + CORE + j] -= scale * columns[j, i]


@compiled
def _spread(
    state: Array, columns: Array, scale: float, new: Array, turned: Array, loose: Array
) -> None:
    """Write what pairs become; move the other columns, and the state, by the state's own motion."""
    n = len(state)
    last = (n + CORE) // 2
    odd, mean, even = np.empty(10), np.empty(10), np.empty(10)
    for j in range(CORE):
        for i in range(BODY):
            loose[j, i], _, loose[CORE + j, i] = _halves(new, i, j, scale)
        for i in range(BODY, last):
            loose[j, i] = columns[j, i]
        for a in range(10):
            odd[a], mean[a], even[a] = _halves(turned, a, j, scale)
        _spread_points(state, columns[j], (scale, odd, mean, even), loose[j], loose[CORE + j])
    for a in range(9):
        mean[a] = turned[a * LANES]
    for j in range(CORE, last):
        _carry(columns[j], mean, j - (j - CORE) % 3)
    _carry(state, mean, CORE)
    for i in range(BODY):
        state[i] = new[i * LANES]
    for r in range(last + 2, n, 3):
        state[r] += turned[9 * LANES]


@compiled
def _halves(values: Array, i: int, j: int, scale: float) -> tuple[float, float, float]:
    """Half the difference of a pair, half its sum, and that without the state's, by the scale."""
    at, up = values[i * LANES], values[i * LANES + 1 + j]
    down = values[i * LANES + 1 + CORE + j]
    return 0.5 * (up - down) / scale, 0.5 * (up + down), (0.5 * (up + down) - at) / scale


@compiled
def _spread_points(
    state: Array,
    column: Array,
    turned: tuple[float, Array, Array, Array],
    up: Array,
    beside: Array,
) -> None:
    """Write half the differences, and half the sums, of what a pair's points are in the camera."""
    scale, odd, mean, even = turned
    half = (len(state) - CORE) // 2
    for p in range(CORE, CORE + half, 3):
        x, y, z = state[p], state[p + 1], state[p + 2]
        u, v, w = scale * column[p], scale * column[p + 1], scale * column[p + 2]
        for a in range(3):
            r, b = p + half + a, 3 * a
            up[r] = column[r] + odd[b] * x + odd[b + 1] * y + odd[b + 2] * z
            up[r] += (mean[b] * u + mean[b + 1] * v + mean[b + 2] * w) / scale
            beside[r] = even[b] * x + even[b + 1] * y + even[b + 2] * z
            beside[r] += odd[b] * u + odd[b + 1] * v + odd[b + 2] * w
        up[p + half + 2] += odd[9]
        beside[p + half + 2] += even[9]


@compiled
def _carry(row: Array, turned: Array, first: int) -> None:
    """Add what points in the body, from the first on, become to those in the camera."""
    half = (len(row) - CORE) // 2
    for p in range(first, CORE + half, 3):
        x, y, z = row[p], row[p + 1], row[p + 2]
        for a in range(3):
            row[p + half + a] += turned[3 * a] * x + turned[3 * a + 1] * y + turned[3 * a + 2] * z


@compiled
def shown_pairs(
    state: Array, columns: Array, scale: float, focal: float
) -> tuple[Array, Array, Array]:
    """What states (run, n) and pairs along their columns show; see `PairedSteps.show`."""
    runs, n = state.shape
    first, half, m = (n + CORE) // 2, 0.5 / scale, (n - CORE) // 3 + 1
    shown, odd, even = np.empty((runs, m)), np.zeros((runs, n, m)), np.zeros((runs, n, m))
    for run in range(runs):
        at, along, beside = state[run], odd[run], even[run]
        for i in range(m // 2):
            shown[run, 2 * i], shown[run, 2 * i + 1] = _pixel(at, at, first + 3 * i, 0.0, focal)
        shown[run, m - 1] = _range(at, at, 0.0)
        for j in range(n):
            column, q = columns[run, j], max(0, 2 * ((j - first) // 3))
            for r in range(first + 3 * q // 2, n, 3):
                x, y = _pixel(at, column, r, scale, focal)
                u, v = _pixel(at, column, r, -scale, focal)
                along[j, q], beside[j, q] = x - u, x + u
                along[j, q + 1], beside[j, q + 1] = y - v, y + v
                q += 2
            far, near = _range(at, column, scale), _range(at, column, -scale)
            along[j, m - 1], beside[j, m - 1] = far - near, far + near
            for q in range(max(0, 2 * ((j - first) // 3)), m):
                along[j, q] *= half
                beside[j, q] = half * (beside[j, q] - 2.0 * shown[run, q])
    return shown, odd, even


@compiled
def _pixel(at: Array, column: Array, r: int, scale: float, focal: float) -> tuple[float, float]:
    """Image of the point that begins at component r."""
    ahead = focal / (at[r + 2] + scale * column[r + 2])
    return (at[r] + scale * column[r]) * ahead, (at[r + 1] + scale * column[r + 1]) * ahead


@compiled
def _range(at: Array, column: Array, scale: float) -> float:
    x, y, z = at[7] + scale * column[7], at[8] + scale * column[8], at[9] + scale * column[9]
    return float(np.sqrt(x * x + y * y + z * z))
