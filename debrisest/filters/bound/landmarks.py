"""Cramer-Rao bound of a landmark model, as the errors of the efficient estimator.

As in `debrisest.filters.bound.motion`, the estimator is linearised at the truth and given the noise
of the very measurements that the others have seen. Here the information is gathered frame by frame,
so that the memory does not grow with the number of landmarks times that of frames, and a false
match is left out with its whole landmark.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.bound.information import Information, gather, moved_covariance, parts
from debrisest.filters.landmark_model import LandmarkModel, Observations, Rows
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.weights import FALSE_MATCH

_BLOCK = 16  # frames whose rows are held at a time


class LandmarkBound(NamedTuple):
    """Errors of the efficient filter at every epoch, and what is to be expected of them."""

    error: Array
    """(run, time, n_c + 3 N)."""
    sigma: Array
    covariance: Array
    """(run, kept, n_c + 3 N, n_c + 3 N)."""
    squares: Array
    """Sum of the squares of the measurements' own noise, by the model, (run,)."""
    dof: Array
    """Their number (run,)."""


def landmark_bound(
    model: LandmarkModel,
    core: Array,
    points: Array,
    parameters: Array,
    covariance: Array,
    observed: Observations,
    keep: Sequence[int] = (),
) -> LandmarkBound:
    """Return the errors of the efficient estimator for the runs of an experiment.

    ``core (run, n)`` and ``points (run, N, 3)`` are the truth at epoch 0, ``parameters (run, n_x)``
    the first guess with the covariance (run, n_x + 3 N, n_x + 3 N) of it and of the points, whose
    first guess is taken as exact. ``keep`` lists the epochs whose covariance is wanted.
    """
    runs, epochs = observed.seen.shape[:2]
    start, by_parameters = model.start(model.parameters(core))
    cores, transitions = model.trajectory(start, epochs - 1)
    n_x, extra = by_parameters.shape[-1], 3 * model.landmarks
    information = scaled_inverse(covariance)
    offset = np.zeros((runs, n_x + extra))
    offset[:, :n_x] = parameters - model.parameters(core)
    held = Information(information, (information @ offset[..., None])[..., 0])
    n_e = model.errors + extra
    error, sigma = np.empty((2, runs, epochs, n_e))
    kept = np.empty((runs, len(keep), n_e, n_e))
    squares, dof = np.zeros((2, runs))
    for part in parts(epochs, keep, _BLOCK):
        at = np.arange(part.start, part.stop)
        rows = model.rows(cores[:, part], points[:, None], at)
        response, residual = _whitened(model, rows, observed.at(slice(None), at))
        squares += (residual**2).sum((1, 2))
        dof += (response != 0.0).any(-1).sum((1, 2))
        moved = transitions[:, part] @ by_parameters[:, None]
        by_core, by_point = np.split(response, [model.errors], axis=-1)
        h = np.concatenate([by_core @ moved, by_point], axis=-1)
        error[:, part], sigma[:, part], spread = gather(held, h, residual, moved)
        for slot in np.flatnonzero(np.asarray(keep) == at[-1]):
            kept[:, slot] = moved_covariance(moved[:, -1], spread)
    return LandmarkBound(error, sigma, kept, squares, dof)


def _whitened(model: LandmarkModel, rows: Rows, observed: Observations) -> tuple[Array, Array]:
    """Rows (run, epoch, m, n_c + 3 N) and residuals of unit noise, zero where nothing counts."""
    residual = (observed.shown - rows.shown) / model.sigma
    near = (np.abs(residual) < FALSE_MATCH) | ~observed.seen
    used = observed.seen & near.all(-1, keepdims=True)
    runs, epochs, landmarks, each = used.shape
    count, n_c = landmarks * each, model.errors
    scale = (used / model.sigma)[..., None]
    flat = np.zeros((runs, epochs, count + model.common, n_c + 3 * landmarks))
    by_core = (rows.by_core * scale).reshape(runs, epochs, count, -1)
    flat[:, :, :count, model.shown_by] = by_core
    row = np.arange(count).reshape(landmarks, each, 1)
    column = n_c + np.arange(3 * landmarks).reshape(landmarks, 1, 3)
    flat[:, :, row, column] = rows.by_point * scale
    weight = observed.common_seen / model.common_sigma
    flat[:, :, count:, model.shown_by] = rows.common_by_core * weight[..., None]
    result = np.concatenate(
        [
            np.where(used, residual, 0.0).reshape(runs, epochs, count),
            np.where(observed.common_seen, (observed.common - rows.common) * weight, 0.0),
        ],
        axis=-1,
    )
    if rows.shared.shape[-1] == 0:
        return flat, result
    shared = (rows.shared * scale).reshape(runs, epochs, count, -1)
    noise = np.eye(count) + shared @ np.swapaxes(shared, -1, -2)
    both = np.concatenate([flat[:, :, :count], result[:, :, :count, None]], axis=-1)
    both = np.linalg.solve(np.linalg.cholesky(noise), both)
    flat[:, :, :count], result[:, :, :count] = both[..., :-1], both[..., -1]
    return flat, result
