"""Cramer-Rao bound, as the errors of the efficient estimator.

The efficient estimator is the linear one that is linearised at the truth. It is *paired*: given the
prior error and the noise of the very runs that another estimator has seen, its errors can go
through the same statistics, and a ratio to it has little sampling noise. Without process noise the
motion follows from the state at epoch 0, so that the information is gathered there.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array


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


def _moved(transition: Array, error: Array, covariance: Array) -> tuple[Array, Array]:
    moved = transition @ covariance @ np.swapaxes(transition, -1, -2)
    return (transition @ error[..., None])[..., 0], 0.5 * (moved + np.swapaxes(moved, -1, -2))


def _scaled_inverse(matrix: Array) -> Array:
    """Inverse of a positive matrix whose unknowns differ by orders of magnitude."""
    scale = np.diagonal(matrix, 0, -2, -1) ** -0.5
    both = scale[..., :, None] * scale[..., None, :]
    return np.asarray(both * np.linalg.inv(both * matrix))
