"""Errors of an estimated debris orbit, and how large they are beside their covariance."""

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.assessment.nees import covariance_epochs, deviation, nees
from debrisest.attitude import quaternion
from debrisest.problems.orbit_from_pixels.model import ORBIT
from debrisest.sensors import pinhole

LOST_PX = 10.0
"""A track whose point is farther than this from the debris' own is lost."""
FAR_M = 5e3
"""A position that is farther off than this is of no use."""


def scores(data: Data) -> Data:
    """Return errors and consistency, as far as there is a truth."""
    result = _spread(data)
    if "orbit_position" not in data or "true_q_ic" not in data:
        return result
    with np.errstate(invalid="ignore"):
        return result | _errors(data) | _consistency(data)


def true_bias(data: Data) -> Array:
    """Error of the known attitude (run, time, observer, 3), rotation vector in camera axes."""
    true, known = data["true_q_ic"], data["known_q_ic"]
    return quaternion.log(quaternion.multiply(quaternion.conjugate(true), known))


def _spread(data: Data) -> Data:
    position = np.sum(data["debris_position_sigma"] ** 2, axis=-1)
    velocity = np.sum(data["debris_velocity_sigma"] ** 2, axis=-1)
    return {"position_spread": np.sqrt(position), "covariance_trace": position + velocity}


def _errors(data: Data) -> Data:
    error = data["debris_position"] - data["orbit_position"]
    position = np.linalg.norm(error, axis=-1)
    pixel = _pixel_error(data)
    result = {
        "debris_position_error": error,
        "position": position,
        "velocity": np.linalg.norm(data["debris_velocity"] - data["orbit_velocity"], axis=-1),
        "pixel": pixel,
        "lost": (~(pixel <= LOST_PX)).astype(np.float64),
        "far": (~(position <= FAR_M)).astype(np.float64),
    }
    if "attitude_bias" in data:
        wrong = data["attitude_bias"] - true_bias(data)
        result["bias_error"] = np.sqrt(np.mean(wrong**2, axis=(-2, -1)))
    return result


def _pixel_error(data: Data) -> Array:
    """Distance (run, time) of the expected from the true pixel, of the camera where it is worse.

    What is expected counts with the attitude as the estimator knows it, errors that it has
    estimated taken off.
    """
    bias = quaternion.exp(-data["attitude_bias"]) if "attitude_bias" in data else None
    known = data["known_q_ic"]
    q_ic = known if bias is None else quaternion.multiply(known, bias)
    expected = _pixels(data, data["debris_position"], q_ic)
    true = _pixels(data, data["orbit_position"], data["true_q_ic"])
    return np.asarray(np.linalg.norm(expected - true, axis=-1).max(axis=-1))


def _pixels(data: Data, position: Array, q_ic: Array) -> Array:
    """Pixels (run, time, observer, 2) of (run, time, 3), NaN of what is behind a camera."""
    away = position[:, :, None] - data["observer_position"]
    point = quaternion.rotate(quaternion.conjugate(q_ic), away)
    pixel = pinhole.project(point, data["focal_px"][:, None, None])
    return np.where(point[..., 2:] > 0.0, pixel, np.nan)


def _consistency(data: Data) -> Data:
    truth = np.concatenate([data["orbit_position"], data["orbit_velocity"]], axis=-1)
    found = np.concatenate([data["debris_position"], data["debris_velocity"]], axis=-1)
    error = (found - truth)[:, covariance_epochs(data)]
    covariance = data["covariance"][..., ORBIT, ORBIT]
    return nees(data, error, covariance) | deviation(data, error, covariance)
