"""Errors of stereo pose estimates, and how large they are beside their covariance."""

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.assessment.nees import covariance_epochs, deviation, nees
from debrisest.assessment.statistics import per_dimension
from debrisest.attitude import quaternion
from debrisest.attitude.vectors import matrix_of_cross
from debrisest.problems.stereo_pose.chart import difference, plain_difference, robocentric
from debrisest.problems.stereo_pose.data import state_of
from debrisest.problems.stereo_pose.model import K, Q

_MOVING = ("true_position", "true_velocity", "true_q_lt", "true_rate_l")


def scores(data: Data, delay: int) -> Data:
    """Return the errors against the truth ``delay`` epochs later, as far as there is one."""
    if not all(name in data for name in _MOVING):
        return {}
    late = data | {name: _later(data[name], delay) for name in _MOVING}
    with np.errstate(invalid="ignore"):
        result = _errors(late) | _consistency(late)
    if delay == 0 and "square_half_way" in data:
        dof = np.where(np.isfinite(data["square_half_way"]), len(data["error_name"]), 0.0)
        result |= {"nees": per_dimension(data["square_half_way"], dof), "nees_dof": dof}
    return result


def _later(values: Array, epochs: int) -> Array:
    """Return the values (run, time, ...) of later epochs, NaN where the time is over."""
    result = np.full(values.shape, np.nan)
    result[:, : values.shape[1] - epochs] = values[:, epochs:]
    return result


def _errors(data: Data) -> Data:
    position = data["position"] - data["true_position"]
    velocity = data["velocity"] - data["true_velocity"]
    rate = data["rate_l"] - data["true_rate_l"]
    ratio = data["inertia_ratio"] - data["true_inertia_ratio"][:, None]
    turn = quaternion.multiply(data["q_lt"], quaternion.conjugate(data["true_q_lt"]))
    return {
        "position_error": position,
        "velocity_error": velocity,
        "rate_error": rate,
        "inertia_ratio_error": ratio,
        "position": np.linalg.norm(position, axis=-1),
        "velocity": np.linalg.norm(velocity, axis=-1),
        "rate": np.linalg.norm(rate, axis=-1),
        "attitude": np.linalg.norm(quaternion.log(turn), axis=-1),
        "k1": np.abs(ratio[..., 0]),
        "k2": np.abs(ratio[..., 1]),
    }


def _consistency(data: Data) -> Data:
    """NEES in the robocentric chart of the estimate, and the deviation of what is told.

    Where the points are is known far better than where the centre of mass is, a thin and curved
    shell in the chart of position and attitude.
    """
    kept = covariance_epochs(data)
    estimated, true = state_of(data)[:, kept], state_of(data, "true_")[:, kept]
    points = data["point_b"].shape[-2]
    plain, chart = plain_covariance(estimated, data["covariance"]), robocentric(estimated, points)
    told = deviation(data, plain_difference(true, estimated), plain)
    covariance = chart @ plain @ _transposed(chart)
    return told | nees(data, difference(true, estimated, points), covariance)


def plain_covariance(state: Array, covariance: Array) -> Array:
    """Covariance (..., n_e, n_e) of plain errors; that of all components (..., n, n) is mapped.

    Of an additive error of the quaternion, what turns is ``2 vec(dq q*)``.
    """
    n = state.shape[-1]
    if covariance.shape[-1] != n:
        return covariance
    w, v = state[..., Q.start, None, None], state[..., Q.start + 1 : Q.stop]
    by_q = np.concatenate([-v[..., None], w * np.eye(3) + matrix_of_cross(v)], axis=-1)
    chart = np.zeros((*state.shape[:-1], n - 1, n))
    chart[..., : Q.start, : Q.start] = np.eye(Q.start)
    chart[..., Q.start : Q.start + 3, Q] = 2 * by_q
    chart[..., K.start - 1 :, K.start :] = np.eye(n - K.start)
    return np.asarray(chart @ covariance @ _transposed(chart))


def _transposed(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)
