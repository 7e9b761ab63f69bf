"""What of the inertia a motion shows, and whether a body can have it."""

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.arc import INERTIA, Arc
from debrisest.batch.descent import PRIOR_SIGMA
from debrisest.dynamics import log_inertia

LOST = 0.25  # of the prior's sigma
_SIGMAS = 5.0


def inertia_directions(covariance: Array) -> tuple[Array, Array]:
    """Return sigmas (5,) and directions (5, 5), as columns, of the log-ratios, best first."""
    values, vectors = np.linalg.eigh(covariance[INERTIA, INERTIA])
    return np.sqrt(np.maximum(values, 0.0)), vectors


def lost_directions(covariance: Array) -> int:
    """Return how many of the five numbers of the inertia the data do not show."""
    sigma, _ = inertia_directions(covariance)
    return int(np.sum(sigma > LOST * PRIOR_SIGMA))


def possible(arc: Arc, covariance: Array) -> bool:
    """Return whether, within five sigma, no principal moment exceeds the sum of the others."""
    logs, axes = np.linalg.eigh(np.tensordot(arc.log_inertia, log_inertia.BASIS, 1))
    share = np.exp(logs - logs[-1])
    margin = share[0] + share[1] - 1.0
    by_log = np.array([share[0], share[1], -share[0] - share[1]])
    by_inertia = by_log @ np.einsum("ji,kjl,li->ik", axes, log_inertia.BASIS, axes)
    sigma = np.sqrt(max(by_inertia @ covariance[INERTIA, INERTIA] @ by_inertia, 0.0))
    return bool(margin > -_SIGMAS * sigma - 1e-9)
