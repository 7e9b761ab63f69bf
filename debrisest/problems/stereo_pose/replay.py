"""The stereo pose problem as the replay filter is handed it: rows, transitions, start-up."""

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import cross, matrix_of_cross
from debrisest.dynamics import inertia_ratios
from debrisest.dynamics.relative_orbit import transitions
from debrisest.filters.replay.normal_equations import normal_equations
from debrisest.filters.replay_model import Frames, PointRows, ReplayModel
from debrisest.problems.stereo_pose import chart
from debrisest.problems.stereo_pose.doubts import doubts
from debrisest.problems.stereo_pose.mirror import mirror
from debrisest.problems.stereo_pose.model import (
    POSITION,
    RATE,
    K,
    Q,
    StereoGeometry,
    error_names,
    measurement,
    points_in_view,
    shown_by_points,
    shown_of_points,
    target_acceleration,
)
from debrisest.problems.stereo_pose.start import first_guess

_TURN = slice(6, 14)
"""Plain errors of rate, attitude and ratios."""


def replay_model(known: StereoGeometry, sigma: Array, prior_sigma: Array) -> ReplayModel:
    """Return the problem for `debrisest.filters.replay.replay`.

    ``sigma (m,)`` is the noise of the measurements; ``prior_sigma (n_e,)`` that of the prior, with
    which the start-up places the centre of mass and weighs its guess of the rates.
    """
    points = known.points
    centre = transitions(known.leader, known.steps)
    back = np.asarray(np.linalg.inv(centre), dtype=np.float64)

    def at_epochs(states: Array, turning: Array, first: int, epochs: IntArray) -> PointRows:
        return point_rows(known, states, turning, centre[epochs] @ back[first], epochs)

    def sums(
        states: Array, turning: Array, first: int, epochs: IntArray, measured: Array, weight: Array
    ) -> tuple[Array, ...]:
        at = states, turning, centre[epochs] @ back[first], epochs
        return _compiled(known, sigma, at, measured, weight)

    return ReplayModel(
        trajectory=lambda state, first, last: chart.propagate(known, state, first, last),
        rows=lambda *at: _dense(at_epochs(*at)),
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
        bending=tuple(range(chart.K_ERROR.start, chart.K_ERROR.stop)),
        displace=lambda state, error: chart.displace(state, error, points),
        mirror=lambda state: mirror(state, points),
        point_rows=at_epochs,
        sums=sums if compiled.available() else None,
        course=lambda state, last: _course(known, state, last),
        frames=_frames(known, sigma, centre, back) if compiled.available() else None,
    )


def _frames(known: StereoGeometry, sigma: Array, centre: Array, back: Array) -> Frames:
    """The filter between the anchors, by compiled loops."""
    from debrisest.problems.stereo_pose.carry_loops import carried
    from debrisest.problems.stereo_pose.chart_loops import moved
    from debrisest.problems.stereo_pose.frame_loops import covariances, updated

    camera = *_camera(known), known.rows, sigma

    def carry(
        before: Array,
        after: Array,
        information: Array,
        turning: Array,
        first: int,
        last: int,
        plain: bool,
    ) -> Array:
        returned = centre[first] @ back[last]
        return carried(before, after.copy(), information, turning.copy(), returned, plain)

    def update(
        state: Array,
        information: Array,
        k: int,
        measured: Array,
        weight: Array,
        gate: bool,
        limits: tuple[int, float],
    ) -> Array:
        spin = float(known.leader.rate[2 * k])
        seen = measured, weight
        return updated(state, information, camera, spin, *seen, gate, limits)

    return Frames(carry, update, moved, covariances)


def _compiled(
    known: StereoGeometry,
    sigma: Array,
    at: tuple[Array, Array, Array, IntArray],
    measured: Array,
    weight: Array,
) -> tuple[Array, ...]:
    """Normal equations of what `point_rows` gives of ``at``, by compiled loops."""
    from debrisest.problems.stereo_pose.lane_loops import LANES
    from debrisest.problems.stereo_pose.replay_loops import point_sums

    count = known.points * len(known.rows)
    camera = _camera(known)
    states, turning = (np.ascontiguousarray(part) for part in at[:2])
    centre = np.zeros((6, 6, len(at[2]) + LANES))
    centre[..., :-LANES] = (np.kron(np.eye(2), camera[0]) @ at[2]).T
    seen = np.ascontiguousarray(measured), np.ascontiguousarray(weight)
    found = point_sums(states, turning, centre, camera, known.rows, sigma[:count], *seen)
    if not known.shown.acceleration:
        return found
    shown, by_rest = _acceleration_rows(known, states, turning, at[-1])
    left = measured[..., count:] - shown / sigma[count:]
    rest = normal_equations(by_rest / sigma[count:, None], left, weight[..., count:])
    information, gradient, cost = found
    information[:, :14, :14] += rest[0]
    gradient[:, :14] += rest[1]
    return information, gradient, cost + rest[2]


def _course(known: StereoGeometry, state: Array, last: int) -> tuple[Array, Array]:
    states, epochs = chart.course(known, state, last), np.arange(last + 1)
    if not compiled.available():
        return states, measurement(known, states, epochs)
    from debrisest.problems.stereo_pose.replay_loops import points_shown

    shown = points_shown(states, _camera(known), known.rows)
    if known.shown.acceleration:
        shown = np.concatenate([shown, target_acceleration(known, states, epochs)], -1)
    return states, shown


def _camera(known: StereoGeometry) -> tuple[Array, float]:
    """The cameras' axes (3, 3) in the leader's, and the baseline."""
    return np.eye(3) if known.to_camera is None else known.to_camera.copy(), known.baseline


def _dense(rows: PointRows) -> tuple[Array, Array]:
    return rows.shown, rows.derivative()


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


def point_rows(
    known: StereoGeometry, states: Array, turning: Array, centre: Array, epochs: IntArray
) -> PointRows:
    """Measurements ``(run, epoch, m)`` and their derivatives.

    These are by the plain errors of the epoch at which ``turning (run, epoch, 6, 8)`` and
    ``centre (epoch, 6, 6)`` start; ``states (run, epoch, n)`` are those of ``epochs``.
    """
    (runs, count), points, each = states.shape[:2], known.points, len(known.rows)
    point, velocity = points_in_view(states, points)
    shown = shown_of_points(known, point, velocity)
    by_view = shown_by_points(known, point, velocity)
    arm = (point - states[:, :, None, POSITION])[..., None, :]
    by_view = by_view.reshape(runs, count, points * each, 6)
    by_velocity = by_view[..., 3:]
    by_arm = by_view[..., :3] + by_velocity @ matrix_of_cross(states[..., RATE])
    by_turn = np.empty((runs, count, points, each, 6))
    by_turn[..., :3] = cross(arm, by_velocity.reshape(runs, count, points, each, 3))
    by_turn[..., 3:] = cross(arm, by_arm.reshape(runs, count, points, each, 3))
    derivative = np.empty((runs, count, points * each, 17))
    derivative[..., :6] = by_view @ centre
    derivative[..., _TURN] = by_turn.reshape(runs, count, points * each, 6) @ turning
    derivative[..., 14:] = by_arm @ quaternion.to_matrix(states[..., Q])
    by_point = derivative.reshape(runs, count, points, each, 17)
    predicted = shown.reshape(runs, count, points * each)
    if not known.shown.acceleration:
        return PointRows(predicted, by_point, np.empty((runs, count, 0, 14)))
    acceleration, by_rest = _acceleration_rows(known, states, turning, epochs)
    return PointRows(np.concatenate([predicted, acceleration], -1), by_point, by_rest)


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
    derivative = np.zeros((*states.shape[:2], 3, 14))
    derivative[..., _TURN] = by_errors @ turning
    derivative[..., chart.K_ERROR] += inertia_ratios.acceleration_by_ratios(rate_t, k)
    return inertia_ratios.angular_acceleration(rate_t, k), derivative
