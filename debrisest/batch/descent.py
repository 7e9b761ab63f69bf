"""Least squares of an arc's unknowns, by Levenberg and Marquardt, with a prior on the inertia.

Descents from several arcs go side by side: each has its own damping and prior, and those that have
not ended take their next step in one call of the motion.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.arc import INERTIA, UNKNOWNS, Arc, Course, along, course, displaced, stacked
from debrisest.batch.evidence import Evidence, Normal

PRIOR_SIGMA = 0.8
"""Of each log-ratio of the inertia, about equal moments: a cube to a long rod."""
_WIDEST = 6.0  # length of the log-ratios beyond which no body is looked for
SMALLEST_GAIN = 1e-3
"""Of the chi-square, where a descent ends."""
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
    return descend_all(evidence, [arc], iterations, [held])[0]


def descend_all(
    evidence: Evidence,
    arcs: Sequence[Arc],
    iterations: int,
    held: Sequence[Prior] = (),
    least_gain: float = SMALLEST_GAIN,
) -> list[Descent]:
    """Return the best arc near each of ``arcs``, which share their epoch; ``held`` is of each.

    A descent ends where its next step would lower the chi-square by less than ``least_gain``.
    """
    held = held or [NOTHING_ELSE] * len(arcs)
    starts = zip(arcs, held, _normals(evidence, arcs, held))
    walks = [_Walk(arc, prior, *normal) for arc, prior, normal in starts]
    for _ in range(iterations):
        tried = [
            (walk, walk.next(evidence.unknowns_fixed, least_gain))
            for walk in walks
            if not walk.ended
        ]
        going = [(walk, arc) for walk, arc in tried if not walk.ended]
        if not going:
            break
        normals = _normals(evidence, [arc for _, arc in going], [walk.held for walk, _ in going])
        for (walk, arc), (normal, total) in zip(going, normals):
            walk.judge(arc, normal, total)
    return [Descent(walk.arc, walk.normal.chi2, walk.normal.hold, walk.settled) for walk in walks]


class _Walk:
    """A descent on its way."""

    def __init__(self, arc: Arc, held: Prior, normal: Normal, lowest: float) -> None:
        self.arc, self.held, self.normal, self.lowest = arc, held, normal, lowest
        self.damping = 1e-6
        self.settled = self.ended = False

    def next(self, fixed: int, least_gain: float) -> Arc:
        """Return the arc to try; the walk ends where that would gain nothing."""
        step, gain = _step(self.normal, self.damping, fixed)
        self.settled = self.ended = gain < least_gain
        return displaced(self.arc, step)

    def judge(self, arc: Arc, normal: Normal, total: float) -> None:
        """Go to a better arc, or try a shorter step next."""
        if total < self.lowest:
            self.arc, self.normal, self.lowest = arc, normal, total
            self.damping = max(0.1 * self.damping, _LEAST_DAMPING)
        elif self.damping > _MOST_DAMPING:
            self.ended = True
        else:
            self.damping = max(10.0 * self.damping, 1e-6)


def covariance(hold: Array, fixed: int = 0) -> Array:
    """Covariance (11, 11) of information (11, 11); that of the first ``fixed`` unknowns is zero."""
    result = np.zeros_like(hold)
    free = slice(fixed, None)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hold)[free], np.finfo(float).tiny))
    both = scale[:, None] * scale
    result[free, free] = both * np.linalg.pinv(both * hold[free, free], 1e-15, hermitian=True)
    return result


def costs(evidence: Evidence, arcs: Sequence[Arc]) -> Array:
    """Return chi-squares (arc,) with the wide prior, infinite where no body is looked for."""
    result = np.full(len(arcs), np.inf)
    sought = [k for k, arc in enumerate(arcs) if _sought(arc)]
    if sought:
        with np.errstate(over="ignore", invalid="ignore"):
            motions = along(stacked([arcs[k] for k in sought]), evidence.times)
            for k, q, rate in zip(sought, *motions):
                result[k] = evidence.chi2(q, rate) + _prior(arcs[k], NOTHING_ELSE)
    return np.where(np.isfinite(result), result, np.inf)


def _normals(
    evidence: Evidence, arcs: Sequence[Arc], held: Sequence[Prior]
) -> list[tuple[Normal, float]]:
    """Return the normal equations and the cost of each, infinite where no body is looked for."""
    result = [(_NOWHERE, np.inf)] * len(arcs)
    sought = [k for k, arc in enumerate(arcs) if _sought(arc)]
    if sought:
        with np.errstate(over="ignore", invalid="ignore"):
            courses = course(stacked([arcs[k] for k in sought]), evidence.times)
            for k, parts in zip(sought, zip(*courses)):
                result[k] = _with_prior(evidence.normal(Course(*parts)), arcs[k], held[k])
    return result


def _with_prior(normal: Normal, arc: Arc, held: Prior) -> tuple[Normal, float]:
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
