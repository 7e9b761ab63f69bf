"""Covariance where the data leave much of the inertia open, and the least squares are not linear.

Along a direction of the inertia that the data hardly show, the valley of the chi-square bends: the
other unknowns move with the square of the way along it, which no second derivative at its floor
tells. So the floor is followed, one sigma to both sides, and the bend is added.
"""

from itertools import combinations

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
    """Return the covariance (11, 11) with the bends of wide directions, and of pairs, added."""
    result = covariance.copy()
    sigma, _ = inertia_directions(covariance)
    wide = np.flatnonzero(sigma > _WIDE)
    for way in np.eye(5)[wide]:
        bend = _bend(evidence, arc, covariance, way)
        result += _FOURTH_MOMENT * np.outer(bend, bend)
    for first, second in combinations(np.eye(5)[wide], 2):
        ahead, across = (
            _bend(evidence, arc, covariance, first + sign * second) for sign in (1.0, -1.0)
        )
        result += 0.25 * np.outer(ahead - across, ahead - across)
    return result


def _bend(evidence: Evidence, arc: Arc, covariance: Array, way: Array) -> Array:
    """Return the mean shift (11,) of the valley's floor at both ends of a way, from the middle.

    ``way (5,)``: how many sigmas along each direction of the inertia; it is held where not zero.
    """
    sigma, directions = inertia_directions(covariance)
    along = directions[:, way != 0.0]
    step = covariance[:, INERTIA] @ along @ (way / sigma)[way != 0.0]
    firm = (along / (_FIRM * sigma[way != 0.0]) ** 2) @ along.T
    ends = [_floor(evidence, arc, sign * step, firm) for sign in (1.0, -1.0)]
    return 0.5 * (ends[0] + ends[1])


def _floor(evidence: Evidence, arc: Arc, step: Array, firm: Array) -> Array:
    """Return how the unknowns (11) have moved where the inertia is held off by ``step``."""
    start = displaced(arc, step)
    held = descend(evidence, start, 15, Prior(start.log_inertia, firm)).arc
    turn = quaternion.log(quaternion.multiply(held.q, quaternion.conjugate(arc.q)))
    return np.concatenate([turn, held.rate - arc.rate, held.log_inertia - arc.log_inertia])
