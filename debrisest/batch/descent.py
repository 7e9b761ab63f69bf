"""Least squares of an arc's unknowns, by Levenberg and Marquardt, with a prior on the inertia."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.arc import INERTIA, UNKNOWNS, Arc, along, course, displaced
from debrisest.batch.evidence import Evidence, Normal

PRIOR_SIGMA = 0.8
"""Of each log-ratio of the inertia, about equal moments: a cube to a long rod."""
_WIDEST = 6.0  # length of the log-ratios beyond which no body is looked for
_SMALLEST_GAIN = 1e-3  # of the chi-square, where the descent ends
_LEAST_DAMPING, _MOST_DAMPING = 1e-9, 1e8


class Prior(NamedTuple):
    """What else is held of the log-ratios of the inertia, beside the wide prior about zero."""

    centre: Array
    """(5,)."""
    information: Array
    """(5, 5)."""


_NOWHERE = Normal(np.inf, np.zeros(UNKNOWNS), np.zeros((UNKNOWNS, UNKNOWNS)))
NOTHING_ELSE = Prior(np.zeros(5), np.zeros((5, 5)))


class Descent(NamedTuple):
    """Where a descent has ended."""

    arc: Arc
    chi2: float
    """Without the prior."""
    hold: Array
    """Information of the unknowns (11, 11), with the prior."""
    settled: bool
    """Whether no further step gains anything."""


def descend(
    evidence: Evidence, arc: Arc, iterations: int = 30, held: Prior = NOTHING_ELSE
) -> Descent:
    """Return the best arc near ``arc``."""
    damping, settled = 1e-6, False
    normal, lowest = _normal(evidence, arc, held)
    for _ in range(iterations):
        step, gain = _step(normal, damping, evidence.unknowns_fixed)
        if gain < _SMALLEST_GAIN:
            settled = True
            break
        tried = displaced(arc, step)
        there, total = _normal(evidence, tried, held)
        if total < lowest:
            arc, normal, lowest = tried, there, total
            damping = max(0.1 * damping, _LEAST_DAMPING)
        elif damping > _MOST_DAMPING:
            break
        else:
            damping = max(10.0 * damping, 1e-6)
    return Descent(arc, normal.chi2, normal.hold, settled)


def covariance(hold: Array, fixed: int = 0) -> Array:
    """Covariance (11, 11) of information (11, 11); that of the first ``fixed`` unknowns is zero."""
    result = np.zeros_like(hold)
    free = slice(fixed, None)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hold)[free], np.finfo(float).tiny))
    both = scale[:, None] * scale
    result[free, free] = both * np.linalg.pinv(both * hold[free, free], 1e-15, hermitian=True)
    return result


def cost(evidence: Evidence, arc: Arc) -> float:
    """Return the chi-square with the wide prior, infinite where no body is looked for."""
    if not _sought(arc):
        return np.inf
    with np.errstate(over="ignore", invalid="ignore"):
        total = evidence.chi2(*along(arc, evidence.times)) + _prior(arc, NOTHING_ELSE)
    return total if np.isfinite(total) else np.inf


def _normal(evidence: Evidence, arc: Arc, held: Prior) -> tuple[Normal, float]:
    """Return the normal equations and the cost, infinite where no body is looked for."""
    if not _sought(arc):
        return _NOWHERE, np.inf
    with np.errstate(over="ignore", invalid="ignore"):
        normal = evidence.normal(course(arc, evidence.times))
    pull, hold = normal.pull.copy(), normal.hold.copy()
    pull[INERTIA] -= arc.log_inertia * PRIOR_SIGMA**-2
    pull[INERTIA] -= held.information @ (arc.log_inertia - held.centre)
    hold[INERTIA, INERTIA] += PRIOR_SIGMA**-2 * np.eye(5) + held.information
    total = normal.chi2 + _prior(arc, held)
    return Normal(normal.chi2, pull, hold), total if np.isfinite(total) else np.inf


def _sought(arc: Arc) -> bool:
    return bool(np.linalg.norm(arc.log_inertia) < _WIDEST)


def _prior(arc: Arc, held: Prior) -> float:
    off = arc.log_inertia - held.centre
    wide = float(np.sum(arc.log_inertia**2)) / PRIOR_SIGMA**2
    return wide + float(off @ held.information @ off)


def _step(normal: Normal, damping: float, fixed: int) -> tuple[Array, float]:
    """Step (11,), and by how much it should lower the chi-square."""
    free = slice(fixed, None)
    hold, pull = normal.hold[free, free], normal.pull[free]
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hold), np.finfo(float).tiny))
    scaled = scale[:, None] * hold * scale + damping * np.eye(len(scale))
    step = np.zeros(UNKNOWNS)
    step[free] = scale * np.linalg.solve(scaled, scale * pull)
    gain = float(2.0 * step[free] @ pull - step[free] @ hold @ step[free])
    return step, gain
