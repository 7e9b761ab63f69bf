"""Covariance where the data leave much of the inertia open, and the least squares are not linear.

Along a direction of the inertia that the data hardly show, the valley of the chi-square bends: the
other unknowns move with the square of the way along it, which no second derivative at its floor
tells. So the floor is followed, one sigma to both sides, and the bend is added.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.batch.arc import INERTIA, Arc, displaced
from debrisest.batch.descent import Prior, descend
from debrisest.batch.evidence import Evidence
from debrisest.batch.observability import inertia_directions

_WIDE = 0.04  # sigma of a log-ratio from which the valley is followed
_FIRM = 1e-3  # sigma with which a point of the valley is held, in sigmas of the direction
_FOURTH_MOMENT = 3.0  # of a Gaussian: mean square of a square


def with_curvature(evidence: Evidence, arc: Arc, covariance: Array) -> Array:
    """Return the covariance (11, 11) with the bends of wide directions added."""
    result = covariance.copy()
    sigma, directions = inertia_directions(covariance)
    for width, direction in zip(sigma, directions.T):
        if width > _WIDE:
            slope = covariance[:, INERTIA] @ direction / width
            ways = [_valley(evidence, arc, sign * slope, direction, width) for sign in (1.0, -1.0)]
            bend = 0.5 * (ways[0] + ways[1])
            result += _FOURTH_MOMENT * np.outer(bend, bend)
    return result


def _valley(evidence: Evidence, arc: Arc, step: Array, direction: Array, width: float) -> Array:
    """Return how the unknowns (11) have moved where the inertia is held off by ``step``."""
    start = displaced(arc, step)
    firm = (_FIRM * width) ** -2 * np.outer(direction, direction)
    held = descend(evidence, start, 15, Prior(start.log_inertia, firm)).arc
    turn = quaternion.log(quaternion.multiply(held.q, quaternion.conjugate(arc.q)))
    return np.concatenate([turn, held.rate - arc.rate, held.log_inertia - arc.log_inertia])
