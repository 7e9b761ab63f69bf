"""Whether an accepted estimate is right: within five of its own sigmas in what it claims.

Attitude and rate are judged at the epochs whose covariance was kept, from the first to the last
that was measured, the inertia along the directions that the motion shows. Where the points are
unknown, the axes of an estimate are those of the truth at the epoch that names them, where its
attitude has no error.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.assessment.consistency import normalized_square
from debrisest.assessment.nees import covariance_epochs
from debrisest.attitude import quaternion
from debrisest.batch.arc import INERTIA, RATE, TURN
from debrisest.batch.descent import PRIOR_SIGMA
from debrisest.batch.observability import LOST
from debrisest.dynamics.log_inertia import BASIS
from debrisest.problems.tumbling import points_motion as body
from debrisest.problems.tumbling.points_inertia import log_tensor

_FIVE_SIGMA = 31.8  # chi-square of three that a Gaussian exceeds as often as five sigma
_FEWEST_EPOCHS = 6  # with three points, from which a motion can start
_NAMES_AXES = 1e-8  # rad, sigma of the attitude below which an epoch only names the axes


def right_or_wrong(data: Data, truth: Array, frame_is_free: bool) -> Data:
    """Return what became of each run (run,), 1 for yes, from the true states (run, time, 12)."""
    if frame_is_free:
        truth = _in_estimated_axes(data, truth)
    wrong = _motion_off(data, truth) | _inertia_off(data, truth[:, -1, body.LOG_INERTIA])
    accepted, able = data["accepted"] == 1.0, startable(data)
    found = {
        "startable": able,
        "accepted_and_right": accepted & ~wrong,
        "accepted_and_wrong": accepted & wrong,
        "missed": able & ~(accepted & ~wrong),
    }
    return {name: np.asarray(value, dtype=np.float64) for name, value in found.items()}


def startable(data: Data) -> BoolArray:
    """Return whether six epochs of a run (run,) show three points that are not in line."""
    points, sigma = data["measured_point"], data["point_noise"]
    seen = np.isfinite(points[..., :1])
    true = np.where(seen, data["true_point_b"][:, None], 0.0)
    count = np.maximum(seen.sum(axis=-2, keepdims=True), 1)
    centred = np.where(seen, true - true.sum(axis=-2, keepdims=True) / count, 0.0)
    spread = np.linalg.eigvalsh(np.swapaxes(centred, -1, -2) @ centred)
    wide = (spread[..., 1] > (2.0 * sigma[:, None]) ** 2) & (count[..., 0, 0] >= 3)
    return np.asarray(wide.sum(axis=-1) >= _FEWEST_EPOCHS)


def _in_estimated_axes(data: Data, truth: Array) -> Array:
    """Return the true states in the axes of the estimate, from its surest epoch."""
    loose = np.nan_to_num(data["q_if_sigma"].sum(axis=-1), nan=np.inf)
    runs, surest = np.arange(len(loose)), loose.argmin(axis=-1)
    q_true = truth[runs, surest, body.Q]
    turn = quaternion.multiply(quaternion.conjugate(data["q_if"][runs, surest]), q_true)
    axes = quaternion.to_matrix(turn)
    tensor = log_tensor(truth[:, -1, body.LOG_INERTIA])
    logs = (axes @ tensor @ np.swapaxes(axes, -1, -2))[:, [0, 1, 0, 0, 1], [0, 1, 1, 2, 2]]
    turned = truth.copy()
    back = quaternion.conjugate(turn)[:, None]
    turned[..., body.Q] = quaternion.multiply(truth[..., body.Q], back)
    turned[..., body.RATE] = quaternion.rotate(turn[:, None], truth[..., body.RATE])
    turned[..., body.LOG_INERTIA] = logs[:, None]
    return turned


def _motion_off(data: Data, truth: Array) -> BoolArray:
    """Whether attitude or rate of a run (run,) is off at a kept epoch within the measured ones."""
    kept = covariance_epochs(data)
    back = quaternion.conjugate(truth[:, kept, body.Q])
    turn = quaternion.log(quaternion.multiply(data["q_if"][:, kept], back))
    rate = data["rate_f"][:, kept] - truth[:, kept, body.RATE]
    covariance = data["covariance"]
    names = np.trace(covariance[..., TURN, TURN], axis1=-2, axis2=-1) < _NAMES_AXES**2
    turn[names] = np.nan
    squares = np.maximum(
        np.nan_to_num(normalized_square(turn, covariance[..., TURN, TURN])),
        np.nan_to_num(normalized_square(rate, covariance[..., RATE, RATE])),
    )
    measured = data["observations_used"] + data["rejected"] > 0
    inside = np.cumsum(measured, axis=-1).astype(bool)
    inside &= np.cumsum(measured[:, ::-1], axis=-1)[:, ::-1].astype(bool)
    return np.asarray(np.any((squares > _FIVE_SIGMA) & inside[:, kept], axis=-1))


def _inertia_off(data: Data, true: Array) -> BoolArray:
    """Whether the inertia (run,) is off along a direction that the motion shows."""
    plain = np.linalg.inv(BASIS[:, [0, 1, 0, 0, 1], [0, 1, 1, 2, 2]].T)
    error = np.nan_to_num((data["log_inertia_f"][:, -1] - true) @ plain.T)
    covariance = plain @ np.nan_to_num(data["covariance"][:, -1, INERTIA, INERTIA]) @ plain.T
    variance, directions = np.linalg.eigh(covariance)
    along = np.abs(np.swapaxes(directions, -1, -2) @ error[..., None])[..., 0]
    sigma = np.sqrt(np.maximum(variance, 1e-300))
    shown = sigma < LOST * PRIOR_SIGMA
    return np.asarray(np.any(shown & (along > 5.0 * sigma), axis=-1))
