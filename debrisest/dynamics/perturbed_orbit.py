"""Motion about an oblate Earth under accelerations that are constant over each step, in ECI.

Classical Runge-Kutta; the noise of a discrete-time process, such as the ``w`` of Li et al., Eq 1,
is what is handed over as acceleration.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.dynamics.drag import Drag, drag_acceleration
from debrisest.dynamics.kepler import MU_EARTH

J2_EARTH = 1.08262668e-3
RADIUS_EARTH = 6378136.3  # m, equatorial, of the same gravity field
LONGEST_STEP = 5.0
"""Seconds; over 10 minutes in a low orbit the position is then good to 0.1 mm."""


def gravity(position: Array, j2: float = 0.0, mu: float = MU_EARTH) -> Array:
    """Acceleration ``(..., 3)``, m/s^2, of a point mass and the oblateness ``j2``."""
    square = np.sum(position**2, axis=-1, keepdims=True)
    central = -mu * position / (square * np.sqrt(square))
    if not j2:
        return np.asarray(central)
    polar = 5.0 * position[..., 2:] ** 2 / square
    factor = 1.5 * j2 * RADIUS_EARTH**2 / square
    return np.asarray(central * (1.0 + factor * (np.array([1.0, 1.0, 3.0]) - polar)))


def propagate(
    position: Array,
    velocity: Array,
    times: Array,
    j2: float = 0.0,
    acceleration: Array | None = None,
    mu: float = MU_EARTH,
    drag: Drag | None = None,
) -> tuple[Array, Array]:
    """Position and velocity ``(..., time, 3)`` at ``times (time,)``, the first of them the start's.

    ``acceleration (..., time - 1, 3)``, m/s^2, acts in addition, each from one time to the next,
    and so does ``drag``.
    """
    extra = np.zeros((len(times) - 1, 3)) if acceleration is None else acceleration
    state = np.concatenate([position, velocity], axis=-1)
    state = np.broadcast_to(state, (*np.broadcast_shapes(state.shape[:-1], extra.shape[:-2]), 6))
    found = np.empty((*state.shape[:-1], len(times), 6))
    found[..., 0, :] = state
    for k, span in enumerate(np.diff(times)):
        state = advance(state, float(span), j2, extra[..., k, :], mu, drag)
        found[..., k + 1, :] = state
    return found[..., :3], found[..., 3:]


def advance(
    state: Array,
    span: float,
    j2: float = 0.0,
    acceleration: Array | float = 0.0,
    mu: float = MU_EARTH,
    drag: Drag | None = None,
) -> Array:
    """State ``(..., 6)``, position and velocity, ``span`` seconds later."""
    count = _steps(span)
    for _ in range(count):
        state = _runge_kutta(state, span / count, j2, acceleration, mu, drag)
    return state


def transition(state: Array, span: float, mu: float = MU_EARTH) -> Array:
    """Derivative ``(..., 6, 6)`` of the state after ``span`` seconds by ``state``, two-body motion.

    A step's is that of a constant gravity gradient, half-way along the straight line, to the third
    order in time.
    """
    count = _steps(span)
    step = span / count
    result = _step_transition(state, step, mu)
    for _ in range(count - 1):
        state = _runge_kutta(state, step, 0.0, 0.0, mu)
        result = _step_transition(state, step, mu) @ result
    return result


def _steps(span: float) -> int:
    return max(1, int(np.ceil(span / LONGEST_STEP - 1e-9)))


def _runge_kutta(
    state: Array,
    step: float,
    j2: float,
    extra: Array | float,
    mu: float,
    drag: Drag | None = None,
) -> Array:
    def derivative(now: Array) -> Array:
        result = np.empty_like(now)
        result[..., :3] = now[..., 3:]
        result[..., 3:] = gravity(now[..., :3], j2, mu) + extra
        if drag is not None:
            result[..., 3:] += drag_acceleration(now[..., :3], now[..., 3:], drag)
        return result

    k1 = derivative(state)
    k2 = derivative(state + 0.5 * step * k1)
    k3 = derivative(state + 0.5 * step * k2)
    k4 = derivative(state + step * k3)
    return np.asarray(state + step / 6.0 * (k1 + 2.0 * (k2 + k3) + k4))


def _step_transition(state: Array, step: float, mu: float) -> Array:
    middle = state[..., :3] + 0.5 * step * state[..., 3:]
    square = np.sum(middle**2, axis=-1)[..., None, None]
    outer = middle[..., :, None] * middle[..., None, :]
    gradient = mu / square**1.5 * (3.0 / square * outer - np.eye(3))
    result = np.empty((*middle.shape[:-1], 6, 6))
    result[..., :3, :3] = result[..., 3:, 3:] = np.eye(3) + 0.5 * step**2 * gradient
    result[..., :3, 3:] = step * np.eye(3) + step**3 / 6.0 * gradient
    result[..., 3:, :3] = step * gradient + step**3 / 6.0 * (gradient @ gradient)
    return result
