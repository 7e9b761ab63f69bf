"""Errors and consistency of pose and shape from one camera and a range.

The truth is taken in the estimator's own body axes, those of the camera at time zero, and scored as
it is and after the best rotation of the points. Symbols: rho, v position and velocity of the chaser
in the Hill frame, w rate, s log-ratios of the inertia.
"""

import numpy as np

from debrisest.arrays import Array, BoolArray, Data, IntArray
from debrisest.assessment.nees import covariance_epochs, deviation, nees
from debrisest.assessment.observability import known_directions
from debrisest.assessment.shape_alignment import best_rotation, rms_distance, shape_error
from debrisest.attitude import quaternion
from debrisest.dynamics import log_inertia
from debrisest.problems.camera_range.by_component import by_component, of_first_guess
from debrisest.target.start_frame import InStartFrame, attitude_in_hill, in_start_frame

TRUE_STATE = (
    *("true_q_ib", "true_rate_b", "true_point_b", "true_inertia_b", "true_q_hc"),
    *("chaser_position_h", "chaser_velocity_h"),
)
"""The datasets of the truth."""
SEEN = 0.05
"""Features seen in a smaller part of the time are not scored."""


def scores(data: Data, camera: str, rows: IntArray, log_inertia_sigma: float | None = None) -> Data:
    """Return the errors, as far as there is a truth, and the consistency.

    ``camera`` names the camera's attitude (run, time, 4), whose first the body axes are taken from;
    ``rows`` tells where in the covariance w, rho, v and, if there are log-ratios, s lie;
    ``log_inertia_sigma`` is what was known of these before.
    """
    if not all(name in data for name in TRUE_STATE):
        return {}
    truth = in_start_frame(data, data[camera][:, 0])
    with np.errstate(invalid="ignore"):
        result = _components(data, truth) | _norms(data, truth) | _aligned(data, truth)
        guess = _of_guess(data, truth)
        result |= _remaining(guess, result) | _consistency(data, result, rows)
        result |= of_first_guess(guess, result, data["time_s"]) | by_component(result)
    if log_inertia_sigma is not None:
        result |= _observability(data, rows[-5:], log_inertia_sigma)
    return result


def scored_features(data: Data) -> BoolArray:
    """Return which features (run, feature) are seen often enough to be scored."""
    return np.asarray(np.isfinite(data["measured_pixel"][:, :, 0, :, 0]).mean(axis=1) > SEEN)


def _components(data: Data, truth: InStartFrame) -> Data:
    attitude, true = _attitudes(data, truth)
    turn = quaternion.log(quaternion.multiply(quaternion.conjugate(true), attitude))
    result: Data = {
        "position_error": data["relative_position_h"] - data["chaser_position_h"],
        "velocity_error": data["relative_velocity_h"] - data["chaser_velocity_h"],
        "rate_error": data["rate_b"] - truth.rate,
        "attitude_error": turn,
        "attitude_error_sigma": _angle_sigma(data),
        "first_point_error": data["point_b"][:, :, 0] - truth.point[:, None, 0],
        "first_point_error_sigma": data["point_b_sigma"][:, :, 0],
        "reference_point_b": truth.point,
    }
    if "inertia_b" in data:
        result["inertia_error"] = data["inertia_b"] - truth.inertia[:, None]
    if "point_c" in data:
        result["first_point_c_error"] = data["point_c"][:, :, 0] - _points_in_camera(data)[:, :, 0]
    if "log_inertia" in data:
        true_s = log_inertia.log_ratios(truth.inertia)
        result["log_inertia_error"] = data["log_inertia"] - true_s[:, None]
    return result


def _norms(data: Data, truth: InStartFrame) -> Data:
    points = _scored_points(data)
    result: Data = {
        "position": _norm(data["relative_position_h"] - data["chaser_position_h"]),
        "velocity": _norm(data["relative_velocity_h"] - data["chaser_velocity_h"]),
        "rate": _norm(data["rate_b"] - truth.rate),
        "attitude": quaternion.angle_between(*_attitudes(data, truth)),
        "points": rms_distance(points, truth.point[:, None]),
        "inertia": shape_error(_inertia(data), truth.inertia[:, None]),
    }
    if "inertia_b" in data:
        result["inertia_tensor"] = _spectral(_inertia(data) - truth.inertia[:, None])
    if "point_c" in data:
        turned = quaternion.rotate(data["q_cb"][..., None, :], data["point_b"])
        turned[..., 2] += _norm(data["relative_position_h"])[..., None]
        result["constraint"] = rms_distance(data["point_c"], turned)
        seen = np.where(scored_features(data)[:, None, :, None], data["point_c"], np.nan)
        result["camera_points"] = rms_distance(seen, _points_in_camera(data))
    return result


def _aligned(data: Data, truth: InStartFrame) -> Data:
    """Errors after the best rotation Q: points Qp, rate Qw, inertia Q I Q^T, attitude R Q^T."""
    points = _scored_points(data)
    turn = best_rotation(points, truth.point[:, None])
    back = np.swapaxes(turn, -1, -2)
    lost: BoolArray = np.asarray(np.isnan(turn[..., 0, 0]))
    q_turn = quaternion.from_matrix(np.where(lost[..., None, None], np.eye(3), turn))
    q_turn[lost] = np.nan
    attitude, true = _attitudes(data, truth)
    turned = quaternion.multiply(attitude, quaternion.conjugate(q_turn))
    return {
        "gauge": _norm(quaternion.log(q_turn)),
        "aligned_rate": _norm((data["rate_b"][..., None, :] @ back)[..., 0, :] - truth.rate),
        "aligned_attitude": quaternion.angle_between(turned, true),
        "aligned_points": rms_distance(points @ back, truth.point[:, None]),
        "aligned_inertia": shape_error(turn @ _inertia(data) @ back, truth.inertia[:, None]),
    }


def _of_guess(data: Data, truth: InStartFrame) -> Data:
    """Errors (run,) of the first guess."""
    guess = {
        "position": _norm(data["start_relative_position_h"] - data["chaser_position_h"][:, 0]),
        "velocity": _norm(data["start_relative_velocity_h"] - data["chaser_velocity_h"][:, 0]),
        "rate": _norm(data["start_rate_b"] - truth.rate[:, 0]),
        "points": rms_distance(data["start_point_b"], truth.point),
    }
    if "start_inertia_b" in data:
        guess["inertia_tensor"] = _spectral(data["start_inertia_b"] - truth.inertia)
    return guess


def _remaining(guess: Data, errors: Data) -> Data:
    """Errors at the end as a part of those of the first guess."""
    names = {name: name for name in guess if name in errors}
    names |= {"aligned_rate": "rate", "aligned_points": "points"}
    return {
        f"{name.replace('_tensor', '')}_remaining": errors[name][:, -1] / guess[first]
        for name, first in names.items()
    }


def _consistency(data: Data, errors: Data, rows: IntArray) -> Data:
    """NEES and deviation of w, rho, v and s.

    The attitude is left out: at zero process noise it follows from the others, and the covariance
    with it is singular.
    """
    kept = covariance_epochs(data)
    names = ("rate_error", "position_error", "velocity_error", "log_inertia_error")
    error = np.concatenate([errors[name][:, kept] for name in names if name in errors], axis=-1)
    covariance = data["covariance"][:, :, rows[:, None], rows]
    return nees(data, error, covariance) | deviation(data, error, covariance)


def _observability(data: Data, rows: IntArray, prior_sigma: float) -> Data:
    """How well the last covariance knows the log-ratios, whose ``rows`` are these."""
    covariance = data["covariance"][:, -1, rows[:, None], rows]
    unknown, worst = known_directions(covariance, prior_sigma)
    return {"unobservable_ratios": unknown.astype(np.float64), "ratio_deviation": worst}


def _attitudes(data: Data, truth: InStartFrame) -> tuple[Array, Array]:
    """The estimated attitude (run, time, 4) and the true one, to Hill or to camera axes."""
    if "q_hb" in data:
        return data["q_hb"], truth.q_he
    return data["q_cb"], quaternion.multiply(quaternion.conjugate(data["true_q_hc"]), truth.q_he)


def _points_in_camera(data: Data) -> Array:
    """True features from the camera, in its axes (run, time, feature, 3), m."""
    to_camera = quaternion.conjugate(data["true_q_hc"])
    q_cb = quaternion.multiply(to_camera, attitude_in_hill(data))
    turned = quaternion.rotate(q_cb[:, :, None], data["true_point_b"][:, None])
    return turned - quaternion.rotate(to_camera, data["chaser_position_h"])[:, :, None]


def _angle_sigma(data: Data) -> Array:
    """1-sigma (run, time, 3) of the attitude's angles, as if it were the same about all axes."""
    components = data["q_hb_sigma"] if "q_hb" in data else data["q_cb_sigma"]
    return np.repeat(2 / np.sqrt(3) * _norm(components)[..., None], 3, axis=-1)


def _scored_points(data: Data) -> Array:
    return np.where(scored_features(data)[:, None, :, None], data["point_b"], np.nan)


def _inertia(data: Data) -> Array:
    """Estimated tensors (run, time, 3, 3), up to scale where only log-ratios are estimated."""
    if "inertia_b" in data:
        return data["inertia_b"]
    s = data["log_inertia"]
    known = np.asarray(np.isfinite(s).all(-1))
    tensor = log_inertia.inertia(np.where(known[..., None], s, 0.0))
    return np.where(known[..., None, None], tensor, np.nan)


def _norm(vector: Array) -> Array:
    return np.asarray(np.linalg.norm(vector, axis=-1))


def _spectral(tensor: Array) -> Array:
    """2-norm of symmetric matrices (..., 3, 3); NaN where one is not finite."""
    sound = np.asarray(np.isfinite(tensor).all((-2, -1)))
    values = np.linalg.eigvalsh(np.where(sound[..., None, None], tensor, 0.0))
    return np.where(sound, np.abs(values).max(-1), np.nan)
