"""Cramer-Rao bound of a system with process noise, known detections assumed."""

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.filters.covariance import solve
from debrisest.filters.scan_model import ScanModel


def posterior_bound(
    model: ScanModel, truth: Array, covariance: Array, detected: Array | BoolArray
) -> Array:
    """Return the least error covariance of every epoch, (run, time, n, n).

    `truth` (run, time, n) are the true states, `covariance` (run, n, n) that of the first guess,
    `detected` (run, time, sensor) which sensors see the target, or with what probability.

    The posterior information of Tichavsky et al. (1998), along the run's own trajectory, in the
    form of covariances, so that the process noise may be singular: of a Kalman filter linearised at
    the truth. A probability q takes the information of a sensor q times: a little optimistic, as
    the information is not lost by halves.
    """
    epochs = truth.shape[1]
    bound = np.empty((*truth.shape, truth.shape[-1]))
    for k in range(epochs):
        if k > 0:
            phi = model.process_jacobian(truth[:, k - 1], k - 1)
            covariance = phi @ covariance @ np.swapaxes(phi, -2, -1) + model.process_noise
        h = model.points_jacobian(truth[:, k], k)
        covariance = _updated(covariance, h, model.noise, np.asarray(detected[:, k], float))
        bound[:, k] = covariance
    return bound


def _updated(covariance: Array, derivative: Array, noise: Array, detected: Array) -> Array:
    """Joseph's update by all sensors, the rows of a sensor scaled by sqrt(q)."""
    sensors, d, n = derivative.shape[-3:]
    share = np.sqrt(detected)[..., None, None]
    h = np.where(share > 0.0, share * derivative, 0.0).reshape(-1, sensors * d, n)
    every = np.kron(np.eye(sensors), noise)
    cross = h @ covariance
    gain = solve(cross @ np.swapaxes(h, -2, -1) + every, cross)
    kept = np.eye(n) - np.swapaxes(h, -2, -1) @ gain
    updated = np.swapaxes(kept, -2, -1) @ covariance @ kept
    updated = updated + np.swapaxes(gain, -2, -1) @ every @ gain
    return np.asarray(0.5 * (updated + np.swapaxes(updated, -2, -1)))
