"""Cramer-Rao bound, as the errors of the efficient estimator.

The efficient estimator is the linear one that is linearised at the truth. It is *paired*: given the
prior error and the noise of the very runs that another estimator has seen, its errors can go
through the same statistics, and a ratio to it has little sampling noise. Without process noise the
motion follows from the state at epoch 0, so that the information is gathered there.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.weights import FALSE_MATCH

_BLOCK = 10  # runs at a time, for the sake of memory


class PairedErrors(NamedTuple):
    """Errors of the efficient filter and smoother, and what is to be expected of them."""

    filter_error: Array
    """(run, time, n_e)."""
    filter_sigma: Array
    filter_covariance: Array
    """(run, kept, n_e, n_e)."""
    smoother_error: Array
    smoother_sigma: Array
    smoother_covariance: Array


class Bound(NamedTuple):
    """Errors of the efficient filter and smoother, estimate minus truth, and their covariances."""

    filter_error: Array
    """(run, time, n_e): what the measurements up to each epoch allow."""
    filter_covariance: Array
    """(run, time, n_e, n_e)."""
    smoother_error: Array
    """(run, time, n_e): what all measurements allow."""
    smoother_covariance: Array
    """(run, time, n_e, n_e)."""


def efficient(
    transition: Array,
    derivative: Array,
    noise: Array,
    sigma: Array,
    prior_error: Array,
    prior_covariance: Array,
) -> Bound:
    """Return the bound of a batch of runs; mind the memory, and hand over a few runs at a time.

    At the truth: ``transition (run, time, n_e, n_e)``, errors of each epoch by those of epoch 0;
    ``derivative (run, time, m, n_e)``, measurements by errors of epoch 0; ``noise (run, time, m)``,
    what was measured minus what the truth shows, NaN where nothing was, with ``sigma (m,)``;
    ``prior_error (run, n_e)``, first guess minus truth, with its covariance ``(n_e, n_e)``.
    """
    seen = ~np.isnan(noise)
    rows = np.where(seen[..., None], derivative, 0.0) / sigma[:, None]
    residual = np.where(seen, noise, 0.0) / sigma
    transposed = np.swapaxes(rows, -1, -2)
    prior = np.linalg.inv(prior_covariance)
    information = np.asarray(prior + np.cumsum(transposed @ rows, axis=1), dtype=np.float64)
    gradient = (prior_error @ prior)[:, None] + np.cumsum(
        (transposed @ residual[..., None])[..., 0], axis=1
    )
    start_covariance = _scaled_inverse(information)
    start_error = (start_covariance @ gradient[..., None])[..., 0]
    last = slice(-1, None)
    return Bound(
        *_moved(transition, start_error, start_covariance),
        *_moved(transition, start_error[:, last], start_covariance[:, last]),
    )


def paired_errors(
    model: ReplayModel,
    truth: Array,
    prior: Array,
    covariance: Array,
    measured: Array,
    keep: Sequence[int] = (),
) -> PairedErrors:
    """Return the plain errors of the efficient estimators for the runs of an experiment.

    ``truth (run, n)`` and ``prior (run, n)`` are states of epoch 0, ``covariance (n_e, n_e)`` the
    prior's, ``measured (run, time, m)``; ``keep`` lists the epochs whose covariance is wanted.
    Outliers, which the efficient estimator tells from the noise of the model, count as missing.
    """
    last, blocks = measured.shape[1] - 1, []
    for begin in range(0, len(truth), _BLOCK):
        runs = np.arange(begin, min(begin + _BLOCK, len(truth)))
        part = model.of(runs)
        states, sensitivity = part.trajectory(truth[runs], 0, last)
        shown, derivative = part.rows(states, sensitivity, 0, np.arange(last + 1))
        transition = [part.transition(sensitivity[:, k], 0, k) for k in range(last + 1)]
        bound = efficient(
            np.stack(transition, axis=1),
            derivative,
            _without_outliers(measured[runs] - shown, model.sigma),
            model.sigma,
            part.plain_difference(prior[runs], truth[runs]),
            covariance,
        )
        blocks.append(
            [
                *(bound[0], _sigma(bound[1]), bound[1][:, list(keep)]),
                *(bound[2], _sigma(bound[3]), bound[3][:, list(keep)]),
            ]
        )
    return PairedErrors(*(np.concatenate(parts) for parts in zip(*blocks)))


def _without_outliers(noise: Array, sigma: Array) -> Array:
    return np.where(np.abs(noise) > FALSE_MATCH * sigma, np.nan, noise)


def _sigma(covariance: Array) -> Array:
    return np.asarray(np.sqrt(np.diagonal(covariance, 0, -2, -1)))


def _moved(transition: Array, error: Array, covariance: Array) -> tuple[Array, Array]:
    moved = transition @ covariance @ np.swapaxes(transition, -1, -2)
    return (transition @ error[..., None])[..., 0], 0.5 * (moved + np.swapaxes(moved, -1, -2))


def _scaled_inverse(matrix: Array) -> Array:
    """Inverse of a positive matrix whose unknowns differ by orders of magnitude."""
    scale = np.diagonal(matrix, 0, -2, -1) ** -0.5
    both = scale[..., :, None] * scale[..., None, :]
    return np.asarray(both * np.linalg.inv(both * matrix))
