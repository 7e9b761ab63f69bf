"""Covariance where the data leave much of the inertia open, and the least squares are not linear.

Along a direction of the inertia that the data hardly show, the valley of the chi-square bends: the
other unknowns move with the square of the way along it, which no second derivative at its floor
tells. So the floor is followed, one sigma to both sides, and the bend is added.
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.attitude import quaternion
from debrisest.batch.arc import INERTIA, Arc, displaced
from debrisest.batch.descent import PRIOR_SIGMA, Descent, Prior, descend
from debrisest.batch.evidence import Evidence
from debrisest.batch.observability import inertia_directions

_WIDE = 0.04  # sigma of a log-ratio from which the valley is followed
_FIRM = 1e-3  # sigma with which a point of the valley is held, in sigmas of the direction
_FOURTH_MOMENT = 3.0  # of a Gaussian: mean square of a square


class _Valley(NamedTuple):
    """The floor of the chi-square one sigma to both sides along a way."""

    step: Array
    """Where it would lie if the least squares were linear (11,)."""
    half: Array
    """Half the way from one end to the other (11,)."""
    bend: Array
    """Middle of the two ends (11,)."""
    rise: float
    """Of chi-square and prior, to the lower end: 1 if the least squares were linear."""


def with_curvature(evidence: Evidence, arc: Arc, covariance: Array) -> Array:
    """Return the covariance (11, 11) with the bends of wide directions, and of pairs, added.

    Where the floor rises less than a Gaussian's, the direction is as much wider, up to the prior.
    """
    result = covariance.copy()
    sigma, _ = inertia_directions(covariance)
    wide = np.flatnonzero(sigma > _WIDE)
    for index in wide:
        valley = _valley(evidence, arc, covariance, np.eye(5)[index])
        wider = 1.0 / np.clip(valley.rise, min(sigma[index] / PRIOR_SIGMA, 1.0) ** 2, 1.0)
        skew = valley.half - valley.step
        result += (wider - 1.0) * np.outer(valley.step, valley.step) + wider * np.outer(skew, skew)
        result += _FOURTH_MOMENT * wider**2 * np.outer(valley.bend, valley.bend)
    for first, second in combinations(np.eye(5)[wide], 2):
        ahead, across = (
            _valley(evidence, arc, covariance, first + sign * second).bend for sign in (1.0, -1.0)
        )
        result += 0.25 * np.outer(ahead - across, ahead - across)
    return result


def _valley(evidence: Evidence, arc: Arc, covariance: Array, way: Array) -> _Valley:
    """Return the floor at both ends of a way.

    ``way (5,)``: how many sigmas along each direction of the inertia; it is held where not zero.
    """
    sigma, directions = inertia_directions(covariance)
    along = directions[:, way != 0.0]
    step = covariance[:, INERTIA] @ along @ (way / sigma)[way != 0.0]
    firm = (along / (_FIRM * sigma[way != 0.0]) ** 2) @ along.T
    ends = [_floor(evidence, arc, sign * step, firm) for sign in (1.0, -1.0)]
    shifts = [_shift(arc, end.arc) for end in ends]
    lowest = min(_cost(end) for end in ends) - _cost(descend(evidence, arc, 0))
    return _Valley(step, 0.5 * (shifts[0] - shifts[1]), 0.5 * (shifts[0] + shifts[1]), lowest)


def _floor(evidence: Evidence, arc: Arc, step: Array, firm: Array) -> Descent:
    """Return the best fit where the inertia is held off by ``step``."""
    start = displaced(arc, step)
    return descend(evidence, start, 15, Prior(start.log_inertia, firm))


def _shift(arc: Arc, other: Arc) -> Array:
    """Return how the unknowns (11) have moved."""
    turn = quaternion.log(quaternion.multiply(other.q, quaternion.conjugate(arc.q)))
    return np.concatenate([turn, other.rate - arc.rate, other.log_inertia - arc.log_inertia])


def _cost(found: Descent) -> float:
    return found.chi2 + float(np.sum(found.arc.log_inertia**2)) / PRIOR_SIGMA**2
