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
from debrisest.filters.bound.information import (
    Information,
    gather,
    moved_covariance,
    moved_errors,
    moved_sigma,
    parts,
)
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.weights import FALSE_MATCH

_BLOCK, _EPOCHS = 10, 50  # runs at a time, for the sake of memory, and epochs


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


def efficient(
    transition: Array,
    derivative: Array,
    noise: Array,
    sigma: Array,
    prior_error: Array,
    prior_covariance: Array,
    keep: Sequence[int] = (),
) -> PairedErrors:
    """Return the errors of a batch of runs; mind the memory, and hand over a few runs at a time.

    At the truth: ``transition (run, time, n_e, n_e)``, errors of each epoch by those of epoch 0;
    ``derivative (run, time, m, n_e)``, measurements by errors of epoch 0; ``noise (run, time, m)``,
    what was measured minus what the truth shows, NaN where nothing was, with ``sigma (m,)``;
    ``prior_error (run, n_e)``, first guess minus truth, with its covariance ``(n_e, n_e)``;
    ``keep`` lists the epochs whose covariance is wanted.
    """
    runs, epochs = noise.shape[:2]
    moved = _without_what_stays(transition)
    prior = np.linalg.inv(prior_covariance)
    held = Information(np.tile(prior, (runs, 1, 1)), prior_error @ prior)
    kept, found = {}, []
    for part in parts(epochs, keep, _EPOCHS):
        seen = ~np.isnan(noise[:, part])
        rows = np.where(seen[..., None], derivative[:, part] / sigma[:, None], 0.0)
        residual = np.where(seen, noise[:, part], 0.0) / sigma
        *errors, kept[part.stop - 1] = gather(held, rows, residual, moved[:, part])
        found.append(errors)
    start = kept[epochs - 1]
    at_start = (start @ held.gradient[..., None])[..., 0]
    covariances = np.empty((2, runs, len(keep), *prior.shape))
    for slot, k in enumerate(keep):
        covariances[0, :, slot] = moved_covariance(moved[:, k], kept[k])
        covariances[1, :, slot] = moved_covariance(moved[:, k], start)
    error, sigma_of_filter = (np.concatenate(each, axis=1) for each in zip(*found))
    return PairedErrors(
        error,
        sigma_of_filter,
        covariances[0],
        moved_errors(moved, at_start[:, None]),
        moved_sigma(moved, start[:, None]),
        covariances[1],
    )


def _without_what_stays(transition: Array) -> Array:
    """The leading block, outside of which errors stay what they are."""
    n = transition.shape[-1]
    moves = (transition != np.eye(n)).any((0, 1))
    own = int(np.flatnonzero(moves.any(0) | moves.any(1)).max(initial=-1)) + 1
    return transition[..., :own, :own]


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
            keep,
        )
        blocks.append(bound)
    return PairedErrors(*(np.concatenate(parts) for parts in zip(*blocks)))


def _without_outliers(noise: Array, sigma: Array) -> Array:
    return np.where(np.abs(noise) > FALSE_MATCH * sigma, np.nan, noise)
