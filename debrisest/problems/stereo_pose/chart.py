"""The stereo pose problem in two charts of its errors, and its whole arcs with sensitivities.

Symbols as in `debrisest.problems.stereo_pose.model`, with ``p_i`` the points and ``v_c`` the
velocity of their mean in ``l``. Attitude errors are rotation vectors in ``l``, applied from the
left, so that there are 14 + 3N errors. The *plain* chart d holds the errors of position, velocity,
rate, attitude, ratios and points in ``t``; the *robocentric* chart e replaces velocity by ``v_c``
and the points by ``p_i``, on which the measurements depend nearly linearly, while position and
attitude, which no measurement shows alone, lie along axes of the chart.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import cross, matrix_of_cross
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.relative_orbit import translation_step
from debrisest.dynamics.relative_rotation import rotation_step
from debrisest.problems.stereo_pose.model import (
    POINTS,
    POSITION,
    RATE,
    VELOCITY,
    K,
    Q,
    StereoGeometry,
)

ATTITUDE_ERROR, K_ERROR, POINT_ERROR = slice(9, 12), slice(12, 14), slice(14, None)
_COMPLEX_STEP = 1e-30
_TURNING = 8
"""Errors that the rotation depends on: rate, attitude, ratios."""


def robocentric(state: Array, points: int) -> Array:
    """Derivative G ``(..., n_e, n_e)`` of the robocentric errors e by the plain errors d."""
    turn, arms, mean, spin = _geometry(state, points)
    n_e = 14 + 3 * points
    result = np.zeros((*state.shape[:-1], n_e, n_e))
    result[..., :, :] = np.eye(n_e)
    by_mean = matrix_of_cross(mean)
    result[..., VELOCITY, RATE] = -by_mean
    result[..., VELOCITY, ATTITUDE_ERROR] = -spin @ by_mean
    for i in range(points):
        block = slice(14 + 3 * i, 17 + 3 * i)
        result[..., VELOCITY, block] = spin @ turn / points
        result[..., block, POSITION] = np.eye(3)
        result[..., block, ATTITUDE_ERROR] = -matrix_of_cross(arms[..., i, :])
        result[..., block, block] = turn
    return result


def plain(state: Array, points: int) -> Array:
    """Inverse ``(..., n_e, n_e)`` of `robocentric`, in closed form."""
    turn, arms, mean, spin = _geometry(state, points)
    back = np.swapaxes(turn, -1, -2)
    n_e = 14 + 3 * points
    result = np.zeros((*state.shape[:-1], n_e, n_e))
    result[..., :, :] = np.eye(n_e)
    result[..., VELOCITY, RATE] = matrix_of_cross(mean)
    result[..., VELOCITY, POSITION] = spin
    for i in range(points):
        block = slice(14 + 3 * i, 17 + 3 * i)
        result[..., VELOCITY, block] = -spin / points
        result[..., block, POSITION] = -back
        result[..., block, ATTITUDE_ERROR] = back @ matrix_of_cross(arms[..., i, :])
        result[..., block, block] = back
    return result


def retract(state: Array, error: Array, points: int) -> Array:
    """State ``(..., n)`` moved by a robocentric error ``(..., n_e)``, its ratios kept physical."""
    result = displace(state, error, points)
    result[..., K] = inertia_ratios.move(state[..., K], error[..., K_ERROR])
    return result


def displace(state: Array, error: Array, points: int) -> Array:
    """State ``(..., n)`` moved by a robocentric error ``(..., n_e)``; inverse of `difference`."""
    position = state[..., POSITION] + error[..., POSITION]
    rate = state[..., RATE] + error[..., RATE]
    cloud, centre_velocity = _cloud(state, points)
    cloud = cloud + error[..., POINT_ERROR].reshape(cloud.shape)
    q = quaternion.multiply(quaternion.exp(error[..., ATTITUDE_ERROR]), state[..., Q])
    arms = cloud - position[..., None, :]
    velocity = centre_velocity + error[..., VELOCITY] - cross(rate, arms.mean(-2))
    body = arms @ quaternion.to_matrix(q)
    k = state[..., K] + error[..., K_ERROR]
    return np.concatenate([position, velocity, rate, q, k, body.reshape(*k.shape[:-1], -1)], -1)


def difference(state: Array, reference: Array, points: int) -> Array:
    """Robocentric error ``(..., n_e)`` that takes the reference to the state; k is additive."""
    cloud, centre_velocity = _cloud(state, points)
    at, at_velocity = _cloud(reference, points)
    error = plain_difference(state, reference)
    error[..., VELOCITY] = centre_velocity - at_velocity
    error[..., POINT_ERROR] = (cloud - at).reshape(*error.shape[:-1], -1)
    return error


def plain_difference(state: Array, reference: Array) -> Array:
    """Plain error ``(..., n_e)`` that takes the reference to the state."""
    turn = quaternion.multiply(state[..., Q], quaternion.conjugate(reference[..., Q]))
    change = state - reference
    return np.concatenate(
        [change[..., : Q.start], quaternion.log(turn), change[..., K], change[..., POINTS]], axis=-1
    )


def propagate(known: StereoGeometry, state: Array, first: int, last: int) -> tuple[Array, Array]:
    """States ``(run, epoch, n)`` of the epochs ``first`` to ``last``, with their sensitivities.

    ``last`` may come before ``first``. Sensitivities ``(run, epoch, 6, 8)`` are those of rate and
    attitude with respect to rate, attitude and ratios at ``first``, by complex steps of eight
    copies; those of the centre's motion are the setup's transition matrices.
    """
    direction = 1 if last >= first else -1
    passed = range(first, last, direction)
    states = np.repeat(state[:, None], len(passed) + 1, axis=1)
    turning = np.empty((*states.shape[:2], 6, _TURNING))
    rate, q, k = _copies(state)
    slope = inertia_ratios.slopes(k)
    position, velocity = state[:, POSITION], state[:, VELOCITY]
    turning[:, 0] = _sensitivity(rate, q)
    for epoch, at in enumerate(passed, start=1):
        leader = known.moments_of_step(at, direction)
        step = direction * known.steps[min(at, at + direction)]
        position, velocity = translation_step(position, velocity, leader, step)
        rate, q = rotation_step(rate, q, slope, leader, step)
        states[:, epoch, POSITION], states[:, epoch, VELOCITY] = position, velocity
        states[:, epoch, RATE], states[:, epoch, Q] = rate[:, 0].real, q[:, 0].real
        turning[:, epoch] = _sensitivity(rate, q)
    return states, turning


def rewind(known: StereoGeometry, state: Array, epoch: int) -> Array:
    """State ``(run, n)`` at epoch 0 of the motion that passes through ``state`` at ``epoch``."""
    result, slope = state.copy(), inertia_ratios.slopes(state[:, K])
    for k in range(epoch, 0, -1):
        leader = known.moments_of_step(k, -1)
        result[:, POSITION], result[:, VELOCITY] = translation_step(
            result[:, POSITION], result[:, VELOCITY], leader, -known.steps[k - 1]
        )
        result[:, RATE], result[:, Q] = rotation_step(
            result[:, RATE], result[:, Q], slope, leader, -known.steps[k - 1]
        )
    return result


def _copies(state: Array) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Rate, ``q_lt`` and ratios ``(run, 8, ...)``, each copy with one of the errors, imaginary."""
    seed = 1j * _COMPLEX_STEP * np.eye(_TURNING)
    turn = np.concatenate([np.zeros((_TURNING, 1)), 0.5 * seed[:, 3:6]], axis=-1)
    q = state[:, None, Q] + 0j
    rows = [
        -(turn[:, 1:] * q[..., 1:]).sum(-1, keepdims=True),
        q[..., :1] * turn[:, 1:] + cross(turn[:, 1:], q[..., 1:] + 0 * seed[:, :3]),
    ]
    q = q + np.concatenate(rows, axis=-1)
    return state[:, None, RATE] + seed[:, :3], q, state[:, None, K] + seed[:, 6:8]


def _sensitivity(rate: NDArray[Any], q: NDArray[Any]) -> Array:
    """``(run, 6, 8)`` of complex copies: the attitude error is ``2 vec(dq q*)``, q of unit norm."""
    real, change = q.real, q.imag
    turn = cross(real[..., 1:], change[..., 1:]) + (
        real[..., :1] * change[..., 1:] - change[..., :1] * real[..., 1:]
    )
    both = np.concatenate([rate.imag, 2.0 * turn], axis=-1) / _COMPLEX_STEP
    return np.swapaxes(both, -1, -2)


def _geometry(state: Array, points: int) -> tuple[Array, Array, Array, Array]:
    """D, the arms ``D P_i (..., N, 3)``, their mean and ``[omega]x``."""
    turn = quaternion.to_matrix(state[..., Q])
    body = state[..., POINTS].reshape(*state.shape[:-1], points, 3)
    arms = body @ np.swapaxes(turn, -1, -2)
    return turn, arms, arms.mean(-2), matrix_of_cross(state[..., RATE])


def _cloud(state: Array, points: int) -> tuple[Array, Array]:
    """Points ``p_i (..., N, 3)`` in ``l`` and the velocity ``v_c (..., 3)`` of their mean."""
    _, arms, mean, _ = _geometry(state, points)
    velocity = state[..., VELOCITY] + cross(state[..., RATE], mean)
    return state[..., None, POSITION] + arms, velocity
