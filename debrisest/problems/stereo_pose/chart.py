"""The stereo pose problem in two charts of its errors, and its whole arcs with sensitivities.

Symbols as in `debrisest.problems.stereo_pose.model`, with ``p_i`` the points and ``v_c`` the
velocity of their mean in ``l``. Attitude errors are rotation vectors in ``l``, applied from the
left, so that there are 14 + 3N errors. The *plain* chart d holds the errors of position, velocity,
rate, attitude, ratios and points in ``t``; the *robocentric* chart e replaces velocity by ``v_c``
and the points by ``p_i``, on which the measurements depend nearly linearly, while position and
attitude, which no measurement shows alone, lie along axes of the chart.
"""

from itertools import pairwise

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import cross, matrix_of_cross
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.kepler import MU_EARTH
from debrisest.dynamics.relative_arc import rotation, rotation_arc
from debrisest.dynamics.relative_orbit import translation_step
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


def excess(state: Array, step: Array) -> tuple[Array, Array]:
    """Derivative ``(..., 2, n_e)`` of two slopes of the inertia, and what `retract` cuts."""
    if compiled.available():
        from debrisest.problems.stereo_pose.chart_loops import excess as excess_compiled

        return excess_compiled(state, step)
    rows = np.zeros((*step.shape[:-1], 2, step.shape[-1]))
    rows[..., K_ERROR] = inertia_ratios.slopes_by_ratios(state[..., K])
    return rows, inertia_ratios.excess(state[..., K], step[..., K_ERROR])


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
    attitude with respect to rate, attitude and ratios at ``first``; those of the centre's motion
    are the setup's transition matrices.
    """
    if first == last:
        return state[:, None], np.broadcast_to(np.eye(6, 8), (len(state), 1, 6, 8))
    epochs = _epochs(first, last)
    states = np.repeat(state[:, None], len(epochs), axis=1)
    states[:, :, POSITION], states[:, :, VELOCITY] = _translation(known, state, epochs)
    states[:, :, Q], states[:, :, RATE], turning = rotation_arc(
        known.times[epochs], state[:, Q], state[:, RATE], state[:, K], known.leader.at(2 * epochs)
    )
    return states, turning


def course(known: StereoGeometry, state: Array, last: int) -> Array:
    """States ``(run, epoch, n)`` up to epoch ``last`` of the motion from ``state`` at epoch 0."""
    epochs = np.arange(last + 1)
    states = np.repeat(state[:, None], last + 1, axis=1)
    states[..., POSITION], states[..., VELOCITY] = _translation(known, state, epochs)
    states[..., Q], states[..., RATE] = rotation(
        known.times[epochs], state[:, Q], state[:, RATE], state[:, K], known.leader.at(2 * epochs)
    )
    return states


def rewind(known: StereoGeometry, state: Array, epoch: int) -> Array:
    """State ``(run, n)`` at epoch 0 of the motion that passes through ``state`` at ``epoch``."""
    result, ends = state.copy(), np.array([epoch, 0])
    position, velocity = _translation(known, state, _epochs(epoch, 0))
    result[:, POSITION], result[:, VELOCITY] = position[:, -1], velocity[:, -1]
    q, rate = rotation(
        known.times[ends], state[:, Q], state[:, RATE], state[:, K], known.leader.at(2 * ends)
    )
    result[:, Q], result[:, RATE] = q[:, -1], rate[:, -1]
    return result


def _epochs(first: int, last: int) -> IntArray:
    direction = 1 if last >= first else -1
    return np.arange(first, last + direction, direction)


def _translation(known: StereoGeometry, state: Array, epochs: IntArray) -> tuple[Array, Array]:
    """Positions and velocities ``(run, epoch, 3)`` of epochs in a row from that of ``state`` on."""
    if compiled.available():
        return _translation_compiled(known, state, epochs)
    positions, velocities = np.empty((2, len(state), len(epochs), 3))
    position, velocity = state[:, POSITION], state[:, VELOCITY]
    positions[:, 0], velocities[:, 0] = position, velocity
    for i, (k, following) in enumerate(pairwise(epochs), start=1):
        leader = known.moments_of_step(k, following - k)
        step = (following - k) * known.steps[min(k, following)]
        position, velocity = translation_step(position, velocity, leader, step)
        positions[:, i], velocities[:, i] = position, velocity
    return positions, velocities


def _translation_compiled(
    known: StereoGeometry, state: Array, epochs: IntArray
) -> tuple[Array, Array]:
    from debrisest.dynamics.relative_orbit_loops import translations

    way = 1 if epochs[-1] >= epochs[0] else -1
    leader = known.leader.at(np.arange(2 * epochs[0], 2 * epochs[-1] + way, way))
    steps = way * known.steps[np.minimum(epochs[:-1], epochs[1:])]
    orbit = np.stack([leader.radius, leader.rate, leader.acceleration], -1)
    moved = translations(state[:, : VELOCITY.stop].copy(), orbit, steps, MU_EARTH)
    return moved[..., POSITION], moved[..., VELOCITY]


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
