"""The stereo pose problem as the replay filter is handed it: rows, transitions, start-up."""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.relative_orbit import transitions
from debrisest.filters.replay_model import ReplayModel
from debrisest.problems.stereo_pose import chart
from debrisest.problems.stereo_pose.doubts import doubts
from debrisest.problems.stereo_pose.model import (
    POSITION,
    RATE,
    K,
    Q,
    StereoGeometry,
    error_names,
    points_in_view,
)
from debrisest.problems.stereo_pose.start import first_guess
from debrisest.sensors import stereo

_TURN = slice(6, 14)
"""Plain errors of rate, attitude and ratios."""


def replay_model(known: StereoGeometry, sigma: Array, prior_sigma: Array) -> ReplayModel:
    """Return the problem for `debrisest.filters.replay.replay`.

    ``sigma (m,)`` is the noise of the measurements; ``prior_sigma (n_e,)`` that of the prior, with
    which the start-up places the centre of mass and weighs its guess of the rates.
    """
    points = known.points
    centre = transitions(known.leader, known.steps)
    back = np.linalg.inv(centre)
    return ReplayModel(
        trajectory=lambda state, first, last: chart.propagate(known, state, first, last),
        rows=lambda states, turning, first, epochs: rows(
            known, states, turning, centre[epochs] @ back[first], epochs
        ),
        transition=lambda turning, first, last: transition(
            turning, centre[last] @ back[first], points
        ),
        rewind=lambda state, epoch: chart.rewind(known, state, epoch),
        chart=lambda state: chart.robocentric(state, points),
        inverse_chart=lambda state: chart.plain(state, points),
        retract=lambda state, error: chart.retract(state, error, points),
        difference=lambda state, reference: chart.difference(state, reference, points),
        plain_difference=chart.plain_difference,
        start=lambda prior, shown, epoch: first_guess(
            known, prior, prior_sigma, shown, sigma, epoch
        ),
        sigma=sigma,
        error_names=error_names("attitude_x attitude_y attitude_z", points),
        excess=chart.excess,
        doubts=doubts(known),
        displace=lambda state, error: chart.displace(state, error, points),
    )


def transition(turning: Array, centre: Array, points: int) -> Array:
    """Derivative ``(run, n_e, n_e)`` of plain errors by those of an earlier or later epoch.

    ``turning (run, 6, 8)`` as of `stereo_pose_chart.propagate`, ``centre (6, 6)`` of the centre.
    """
    n_e = 14 + 3 * points
    result = np.zeros((len(turning), n_e, n_e))
    result[:] = np.eye(n_e)
    result[:, :6, :6] = centre
    result[:, 6:12, _TURN] = turning
    return result


def rows(
    known: StereoGeometry, states: Array, turning: Array, centre: Array, epochs: IntArray
) -> tuple[Array, Array]:
    """Measurements ``(run, epoch, m)`` and their derivative ``(run, epoch, m, n_e)``.

    The derivative is by the plain errors of the epoch at which ``turning (run, epoch, 6, 8)`` and
    ``centre (epoch, 6, 6)`` start; ``states (run, epoch, n)`` are those of ``epochs``.
    """
    points, batch = known.points, states.shape[:2]
    point, velocity = points_in_view(states, points)
    shown = stereo.measure(point, velocity, known.baseline)[..., known.rows]
    by_view = stereo.jacobian(point, velocity, known.baseline)[..., known.rows, :]
    turn = quaternion.to_matrix(states[..., Q])[:, :, None]
    spin = matrix_of_cross(states[..., RATE])[:, :, None]
    arm = matrix_of_cross(point - states[:, :, None, POSITION])
    by_arm = by_view[..., :3] + by_view[..., 3:] @ spin
    by_turn = np.concatenate([-by_view[..., 3:] @ arm, -by_arm @ arm], axis=-1)
    derivative = np.zeros((*batch, points, len(known.rows), 14 + 3 * points))
    derivative[..., :6] = by_view @ centre[:, None]
    derivative[..., _TURN] = by_turn @ turning[:, :, None]
    by_body = by_arm @ turn
    for i in range(points):
        derivative[:, :, i, :, 14 + 3 * i : 17 + 3 * i] = by_body[:, :, i]
    predicted = shown.reshape(*batch, points * len(known.rows))
    flat = derivative.reshape(*predicted.shape, derivative.shape[-1])
    if not known.shown.acceleration:
        return predicted, flat
    acceleration, by_start = _acceleration_rows(known, states, turning, epochs)
    return np.concatenate([predicted, acceleration], -1), np.concatenate([flat, by_start], -2)


def _acceleration_rows(
    known: StereoGeometry, states: Array, turning: Array, epochs: IntArray
) -> tuple[Array, Array]:
    back = np.swapaxes(quaternion.to_matrix(states[..., Q]), -1, -2)
    total = states[..., RATE].copy()
    total[..., 2] += known.leader.rate[2 * epochs]
    rate_t = (back @ total[..., None])[..., 0]
    k = states[..., K]
    by_rate = inertia_ratios.acceleration_by_rate(rate_t, k) @ back
    by_errors = np.concatenate([by_rate, by_rate @ matrix_of_cross(total)], axis=-1)
    derivative = np.zeros((*states.shape[:2], 3, 14 + 3 * known.points))
    derivative[..., _TURN] = by_errors @ turning
    derivative[..., chart.K_ERROR] += inertia_ratios.acceleration_by_ratios(rate_t, k)
    return inertia_ratios.angular_acceleration(rate_t, k), derivative
