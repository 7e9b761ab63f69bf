"""Errors of a tumbling body's estimates, and how large they are beside their covariance.

The body's axes of an estimate are principal axes known only up to a relabeling, see
`debrisest.assessment.principal_axes`.
"""

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.assessment.attitude import attitude_errors, true_feature_attitude
from debrisest.assessment.convergence import convergence_time
from debrisest.assessment.nees import covariance_epochs, nees
from debrisest.assessment.principal_axes import best_relabeling
from debrisest.assessment.statistics import window_mask
from debrisest.attitude import quaternion
from debrisest.dynamics.inertia import principal_axes
from debrisest.roles import Window

CONVERGED = np.radians(0.5)
"""The rate has converged once its error stays below this, rad/s."""


def scores(data: Data, scored: Window, rate_covariance: Array) -> Data:
    """Return errors of attitude, rate and inertia in true principal axes, as far as known.

    ``rate_covariance (run, kept, 3, 3)`` is that of ``rate_b``, at ``covariance_time_s``; NEES is
    that of the rate in the estimate's own axes.
    """
    if "true_q_ib" not in data:
        return {}
    moments, axes = principal_axes(data["true_inertia_b"])
    rate = data["true_rate_b"] @ axes
    inside = window_mask(data["time_s"], scored)
    relabeling = best_relabeling(data["rate_b"][:, inside], rate[:, inside])
    rate_error = data["rate_b"] @ np.swapaxes(relabeling, -1, -2) - rate
    return (
        {"relabeling": relabeling}
        | _attitude_errors(data)
        | _rate_errors(rate_error, data["time_s"])
        | _inertia_errors(data["moments_b"] @ np.abs(np.swapaxes(relabeling, -1, -2)), moments)
        | nees(data, (rate_error @ relabeling)[:, covariance_epochs(data)], rate_covariance)
    )


def _attitude_errors(data: Data) -> Data:
    estimated = quaternion.multiply(data["q_ib"], data["q_bf"])
    pitch_error, angle = attitude_errors(estimated, true_feature_attitude(data))
    return {"pitch": pitch_error, "attitude": angle}


def _rate_errors(error: Array, times: Array) -> Data:
    components = {f"rate_{axis + 1}": error[..., axis] for axis in range(3)}
    norm = np.linalg.norm(error, axis=-1)
    return components | {"rate": norm, "convergence_time": convergence_time(CONVERGED, norm, times)}


def _inertia_errors(estimated: Array, moments: Array) -> Data:
    true = moments / np.linalg.norm(moments, axis=-1, keepdims=True)
    error = estimated - true[:, None]
    return {f"inertia_{axis + 1}": error[..., axis] for axis in range(3)}
