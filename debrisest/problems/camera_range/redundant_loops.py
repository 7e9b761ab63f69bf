"""The step of `redundant_model` as plain loops over sigma points, for `debrisest.compiled`."""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude.rotation_loops import conjugate, matrix_of, product
from debrisest.compiled import compiled
from debrisest.dynamics.tumbling_in_orbit_loops import slopes

_CORE = 19
_PARTS, _WEIGHTS = (0.5, 0.5, 1.0, 0.0), (1.0, 2.0, 2.0, 1.0)


@compiled
def moved(states: Array, orbit: Array, pace: tuple[float, float], duration: float) -> Array:
    """Return states ``(run, copy, n)`` one step later.

    ``orbit (6, 6)`` is the transition of position and velocity, ``pace`` the mean motion and three
    times its square. Copies with the core of the first one are moved by that one's motion.
    """
    result = states.copy()
    points = (states.shape[2] - _CORE) // 6
    turned, first = np.empty((3, 3)), np.empty((3, 3))
    for run in range(len(states)):
        receding = nearest = 0.0
        for copy in range(states.shape[1]):
            state, new = states[run, copy], result[run, copy]
            if copy > 0 and np.all(state[:_CORE] == states[run, 0, :_CORE]):
                new[:_CORE], turned[:], receding = result[run, 0, :_CORE], first, nearest
            else:
                receding = _core_step(state, orbit, pace, duration, new, turned)
            if copy == 0:
                first[:], nearest = turned, receding
            for i in range(_CORE, _CORE + 3 * points, 3):
                x, y, z = state[i], state[i + 1], state[i + 2]
                seen = new[i + 3 * points : i + 3 * points + 3]
                for a in range(3):
                    seen[a] += turned[a, 0] * x + turned[a, 1] * y + turned[a, 2] * z
                seen[2] += receding
    return result


@compiled
def _core_step(
    state: Array,
    orbit: Array,
    pace: tuple[float, float],
    duration: float,
    new: Array,
    turned: Array,
) -> float:
    """Write the core one step later and how its rotation matrix changes; how far it recedes."""
    before = state[:4] / np.sqrt(np.sum(state[:4] ** 2))
    for a in range(6):
        new[7 + a] = 0.0
        for b in range(6):
            new[7 + a] += orbit[a, b] * state[7 + b]
    x = np.empty(7)
    x[:4], x[4:] = product(_camera(state[7:10]), before), state[4:7]
    _turned(x, _body(state[13:19]), pace, duration)
    after = product(conjugate(_camera(new[7:10])), x[:4])
    if np.sum(after * before) < 0.0:
        after = -after
    new[:4], new[4:7] = after, x[4:]
    turned[:] = matrix_of(after) - matrix_of(before)
    return float(np.sqrt(np.sum(new[7:10] ** 2)) - np.sqrt(np.sum(state[7:10] ** 2)))


@compiled
def _turned(
    x: Array, body: tuple[Array, Array, Array], pace: tuple[float, float], duration: float
) -> None:
    """Move attitude and rate (7) by a Runge-Kutta step."""
    start, tried, slope, radial = x.copy(), x.copy(), np.empty(7), np.empty(3)
    room = np.empty(3), np.empty(3), np.empty(3)
    for i in range(4):
        slopes(tried, body, pace, slope[:4], slope[4:], radial, room)
        tried[:] = start + _PARTS[i] * duration * slope
        x += _WEIGHTS[i] * duration / 6.0 * slope
    x[:4] /= np.sqrt(np.sum(x[:4] ** 2))


@compiled
def _body(elements: Array) -> tuple[Array, Array, Array]:
    """Tensor (3, 3) of its elements (6), its inverse, and no derivative."""
    xx, yy, zz, xy, xz, yz = elements
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    inverse = np.empty((3, 3))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        for a in range(3):
            b, c = (a + 1) % 3, (a + 2) % 3
            inverse[a, i] = inertia[j, b] * inertia[k, c] - inertia[j, c] * inertia[k, b]
    inverse /= np.sum(inertia[0] * inverse[:, 0])
    return inertia, inverse, inertia


@compiled
def _camera(position: Array) -> Array:
    """Attitude (4) of `camera_axes`: two half turns."""
    x, y, z = position
    level = np.sqrt(x * x + y * y)
    azimuth, elevation = np.arctan2(y, x), np.arctan2(z, level)
    half = 0.5 * (azimuth + 0.5 * np.pi)
    about = np.array([np.cos(half), 0.0, 0.0, np.sin(half)])
    half = -0.5 * (elevation + 0.5 * np.pi)
    return product(about, np.array([np.cos(half), np.sin(half), 0.0, 0.0]))
