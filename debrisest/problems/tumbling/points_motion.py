"""State and motion of a torque-free body whose axes are those of its features.

The state (12) is ``q_if`` (feature frame to inertial), the rate in the feature frame, rad/s, and
five coordinates of the inertia (`debrisest.problems.tumbling.points_inertia`).

The errors (11) are a rotation vector in inertial axes, applied from the left, and differences. An
error of the attitude is therefore the same at all epochs, and none of the rate.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.dynamics.torque_free import torque_free
from debrisest.problems.tumbling.points_inertia import possible, principal_logs

Q, RATE, LOG_INERTIA = slice(0, 4), slice(4, 7), slice(7, 12)
TURN_ERROR, RATE_ERROR, INERTIA_ERROR = slice(0, 3), slice(3, 6), slice(6, 11)
ERROR_NAMES = tuple(
    [f"attitude_{axis}" for axis in "xyz"]
    + [f"rate_{axis}" for axis in "xyz"]
    + [f"log_inertia_{index}" for index in ("11", "22", "12", "13", "23")]
)
_TURN_OF_STEP = 1e-4
"""How far a difference's step turns the body at the end of the arc, about, rad."""


def motion(state: Array, times: Array) -> tuple[Array, Array]:
    """Return ``q_if (..., time, 4)`` and rates (..., time, 3), at ``times (time,)``, s, from it."""
    logs, axes = principal_logs(state[..., LOG_INERTIA])
    q_fb = quaternion.from_matrix(axes)
    rate_b = (state[..., None, RATE] @ axes)[..., 0, :]
    q_ib, rates_b = torque_free(
        times, quaternion.multiply(state[..., Q], q_fb), rate_b, np.exp(logs)
    )
    q_if = quaternion.multiply(q_ib, quaternion.conjugate(q_fb)[..., None, :])
    return q_if, rates_b @ np.swapaxes(axes, -1, -2)


def moved(state: Array, time: float) -> Array:
    """Return the states (..., 12) ``time`` seconds later."""
    q, rate = motion(state, np.array([time]))
    return np.concatenate([q[..., 0, :], rate[..., 0, :], state[..., 7:]], axis=-1)


def trajectory(state: Array, times: Array) -> tuple[Array, Array]:
    """Return states (run, epoch, 12), and their sensitivities (run, epoch, 6, 8).

    These are the derivatives of attitude and rate by rate and inertia of ``state (run, 12)``, by
    central differences of sixteen copies of the body.
    """
    if not times.any():
        return state[:, None], np.broadcast_to(np.eye(6, 8, -3), (len(state), 1, 6, 8))
    step = _steps(state, times)
    shift = np.concatenate([step, -step], axis=-1) * np.tile(np.eye(8), 2)
    copies = np.repeat(state[:, None], 17, axis=1)
    copies[:, 1:, 4:] += np.swapaxes(shift, -1, -2)
    q, rate = motion(copies, times)
    ahead, back = slice(1, 9), slice(9, 17)
    turn = _small_turn(q[:, ahead], q[:, back])
    change = np.concatenate([turn, rate[:, ahead] - rate[:, back]], axis=-1)
    sensitivity = change / (2.0 * step[:, 0, :, None, None])
    constant = np.repeat(state[:, None, 7:], len(times), axis=1)
    states = np.concatenate([q[:, 0], rate[:, 0], constant], axis=-1)
    return states, np.moveaxis(sensitivity, 1, -1)


def displace(state: Array, error: Array) -> Array:
    """Return states (..., 12) moved by errors (..., 11)."""
    q = quaternion.multiply(quaternion.exp(error[..., TURN_ERROR]), state[..., Q])
    return np.concatenate([q, state[..., 4:] + error[..., 3:]], axis=-1)


def retract(state: Array, error: Array) -> Array:
    """Return states (..., 12) moved by errors (..., 11), their inertia kept that of a body."""
    result = displace(state, error)
    result[..., LOG_INERTIA] = possible(result[..., LOG_INERTIA])
    return result


def difference(state: Array, reference: Array) -> Array:
    """Return the errors (..., 11) that take the reference to the state."""
    turn = quaternion.multiply(state[..., Q], quaternion.conjugate(reference[..., Q]))
    return np.concatenate([quaternion.log(turn), state[..., 4:] - reference[..., 4:]], axis=-1)


def _steps(state: Array, times: Array) -> Array:
    """Steps (run, 1, 8) that move the end of the arc by about as much each."""
    span = 1.0 + np.abs(times).max(initial=0.0)
    speed = np.linalg.norm(state[:, RATE], axis=-1, keepdims=True)
    by_rate = np.full((len(state), 3), _TURN_OF_STEP / span)
    by_inertia = np.repeat(_TURN_OF_STEP / (1.0 + speed * span), 5, axis=-1)
    return np.concatenate([by_rate, by_inertia], axis=-1)[:, None]


def _small_turn(ahead: Array, back: Array) -> Array:
    """Rotation vectors from ``back`` to ``ahead``, to second order in their length."""
    turn = quaternion.multiply(ahead, quaternion.conjugate(back))
    return np.asarray(2.0 * np.copysign(1.0, turn[..., :1]) * turn[..., 1:])
