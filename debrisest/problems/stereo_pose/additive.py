"""The stereo pose problem with an additive quaternion, as the paper's filters are handed it.

The errors are the 15 + 3N components of the state; a correction is added, then the quaternion is
scaled to unit norm. The derivatives are those by the components, without that scaling.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.relative_orbit import relative_acceleration
from debrisest.dynamics.relative_rotation import (
    rotation_by_quaternion,
    rotation_derivative,
    rotation_matrix,
    unrotate,
)
from debrisest.filters.model import Model
from debrisest.problems.stereo_pose.model import (
    POINTS,
    POSITION,
    RATE,
    VELOCITY,
    K,
    Q,
    StereoGeometry,
    error_names,
    measurement,
    points_in_view,
    process,
    shown_by_points,
)

_COMPLEX_STEP = 1e-30
_MOVING = 15


def additive_model(
    known: StereoGeometry, process_noise: Array, measurement_noise: Array, exact: bool = True
) -> Model:
    """Return the model, with covariances ``(n, n)`` per step and ``(m, m)``.

    Without ``exact`` the transition is the printed ``I + F dt``.
    """
    transition = process_jacobian if exact else first_order_transition
    return Model(
        process=lambda state, k: process(known, state, k),
        measurement=lambda state, k: measurement(known, state, k),
        process_noise=process_noise,
        measurement_noise=measurement_noise,
        error_names=error_names("q_lt_0 q_lt_1 q_lt_2 q_lt_3", known.points),
        retract=_correct,
        process_jacobian=lambda state, k: transition(known, state, k),
        measurement_jacobian=lambda state, k: measurement_jacobian(known, state, k),
    )


def _correct(state: Array, error: Array) -> Array:
    corrected = state + error
    corrected[..., Q] /= np.linalg.norm(corrected[..., Q], axis=-1, keepdims=True)
    return corrected


def process_jacobian(known: StereoGeometry, state: Array, k: int) -> Array:
    """Derivative ``(..., n, n)`` of `process`, exact for the discrete step.

    By complex steps of the 15 components that move or are constants of the motion, in one call.
    """
    return _moving_block(state, lambda copies: process(known, copies, k))


def first_order_transition(known: StereoGeometry, state: Array, k: int) -> Array:
    """``I + F dt (..., n, n)`` as printed (Eq 46), F the derivative of the equations of motion."""
    leader = known.leader.at(2 * k)

    def motion(copies: NDArray[Any]) -> NDArray[Any]:
        result = np.zeros_like(copies)
        result[..., POSITION] = copies[..., VELOCITY]
        result[..., VELOCITY] = relative_acceleration(
            copies[..., POSITION], copies[..., VELOCITY], leader
        )
        result[..., RATE], result[..., Q] = rotation_derivative(
            copies[..., RATE],
            copies[..., Q],
            inertia_ratios.slopes(copies[..., K]),
            leader,
            known.raw_rotation,
        )
        return np.asarray(copies + known.steps[k] * result)

    return _moving_block(state, motion)


def measurement_jacobian(known: StereoGeometry, state: Array, k: int) -> Array:
    """Derivative ``(..., m, n)`` of `measurement`: cameras in closed form, the rest by chain."""
    raw, batch, n = known.raw_rotation, state.shape[:-1], state.shape[-1]
    point, velocity = points_in_view(state, known.points, raw)
    by_view = shown_by_points(known, point, velocity)
    rows = by_view.shape[-2]
    by_point, by_velocity = by_view[..., :3], by_view[..., 3:]
    turn = matrix_of_cross(state[..., RATE])[..., None, :, :]
    by_arm = by_point + by_velocity @ turn
    body = state[..., POINTS].reshape(*batch, known.points, 3)
    q = state[..., None, Q]
    result = np.zeros((*batch, known.points, rows, n))
    result[..., POSITION] = by_point
    result[..., VELOCITY] = by_velocity
    result[..., RATE] = -by_velocity @ matrix_of_cross(point - state[..., None, POSITION])
    result[..., Q] = by_arm @ rotation_by_quaternion(q, body, raw)
    by_body = by_arm @ rotation_matrix(q, raw)
    for i in range(known.points):
        result[..., i, :, 15 + 3 * i : 18 + 3 * i] = by_body[..., i, :, :]
    flat = result.reshape(*batch, known.points * rows, n)
    if not known.shown.acceleration:
        return flat
    return np.concatenate([flat, _acceleration_jacobian(known, state, k)], axis=-2)


def _moving_block(state: Array, function: Callable[[NDArray[Any]], NDArray[Any]]) -> Array:
    """Derivative of a function that leaves the points alone, by complex steps."""
    n = state.shape[-1]
    moving = state[..., None, :_MOVING]
    copies = moving + 1j * _COMPLEX_STEP * np.eye(_MOVING)
    result = np.zeros((*state.shape, n))
    result[..., :] = np.eye(n)
    result[..., :_MOVING, :_MOVING] = np.swapaxes(function(copies).imag, -1, -2) / _COMPLEX_STEP
    return result


def _acceleration_jacobian(known: StereoGeometry, state: Array, k: int) -> Array:
    raw, q, ratios = known.raw_rotation, state[..., Q], state[..., K]
    total = state[..., RATE] + np.array([0.0, 0.0, float(known.leader.rate[2 * k])])
    rate_t = unrotate(q, total, raw)
    by_rate = inertia_ratios.acceleration_by_rate(rate_t, ratios)
    mirror = np.array([1.0, -1.0, -1.0, -1.0])
    result = np.zeros((*state.shape[:-1], 3, state.shape[-1]))
    result[..., RATE] = by_rate @ np.swapaxes(rotation_matrix(q, raw), -1, -2)
    result[..., Q] = by_rate @ (rotation_by_quaternion(q * mirror, total, raw) * mirror)
    result[..., K] = inertia_ratios.acceleration_by_ratios(rate_t, ratios)
    return result
