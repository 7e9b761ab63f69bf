"""Least squares of an arc's unknowns, by Levenberg and Marquardt, with a prior on the inertia.

Descents from several arcs go side by side: each has its own damping and prior, and those that have
not ended take their next step in one call of the motion.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.batch.arc import (
    INERTIA,
    TURN_OF_STEP,
    UNKNOWNS,
    Arc,
    along,
    chosen,
    course,
    displaced,
    stacked,
)
from debrisest.batch.evidence import Evidence, Normal
from debrisest.batch.point_sums import KnownPoints

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
    if isinstance(evidence, KnownPoints) and compiled.available():
        return _descended(evidence, stacked(arcs), held, iterations, least_gain)
    walks = _Walks(evidence, stacked(arcs), held)
    for _ in range(iterations):
        if not walks.go_on(least_gain):
            break
    return walks.ends()


def _descended(
    evidence: KnownPoints, arcs: Arc, held: Sequence[Prior], iterations: int, least_gain: float
) -> list[Descent]:
    """The same by compiled loops, on known points."""
    from debrisest.batch.descent_loops import descent, epochs_of, room_of

    times, settings = evidence.times - arcs.epoch, for_loops(least_gain)
    epochs, room, found = epochs_of(times, evidence.loop_sums), room_of(len(times)), []
    for k, prior in enumerate(held):
        hold, arc = np.zeros((11, 11)), chosen(arcs, k)
        at = arc.q.copy(), arc.rate.copy(), arc.log_inertia.copy()
        own = prior.centre, prior.information
        chi2, settled = descent(epochs, at, own, iterations, settings, room, hold)
        found.append(Descent(Arc(arcs.epoch, *at), chi2, hold, settled))
    return found


def for_loops(least_gain: float = SMALLEST_GAIN) -> tuple[float, float, float, float, float, float]:
    """Return the settings of `descent_loops`."""
    return least_gain, PRIOR_SIGMA, _WIDEST, _LEAST_DAMPING, _MOST_DAMPING, TURN_OF_STEP


class _Walks:
    """Descents on their way; all arrays have the descent first."""

    def __init__(self, evidence: Evidence, arcs: Arc, held: Sequence[Prior]) -> None:
        self.evidence, self.arcs = evidence, arcs
        self.held = Prior(*(np.stack(parts) for parts in zip(*held)))
        count = len(held)
        self.normal, self.lowest = self._at(arcs, np.arange(count))
        self.damping = np.full(count, 1e-6)
        self.settled, self.ended = np.zeros((2, count), dtype=bool)

    def go_on(self, least_gain: float) -> bool:
        """Take the next steps, shorter ones after those that went up; whether any was taken.

        A descent ends where that would gain nothing.
        """
        going = np.flatnonzero(~self.ended)
        normal = Normal(*(part[going] for part in self.normal))
        step, gain = _steps(normal, self.damping[going], self.evidence.unknowns_fixed)
        settled = gain < least_gain
        self.settled[going] = self.ended[going] = settled
        going, step = going[~settled], step[~settled]
        if not len(going):
            return False
        arcs = displaced(chosen(self.arcs, going), step)
        normal, total = self._at(arcs, going)
        lower = total < self.lowest[going]
        better, worse = going[lower], going[~lower]
        for old, new in zip((*self.arcs[1:], *self.normal), (*arcs[1:], *normal)):
            old[better] = new[lower]
        self.lowest[better] = total[lower]
        self.ended[worse] = self.damping[worse] > _MOST_DAMPING
        self.damping[better] = np.maximum(0.1 * self.damping[better], _LEAST_DAMPING)
        self.damping[worse] = np.maximum(10.0 * self.damping[worse], 1e-6)
        return True

    def ends(self) -> list[Descent]:
        """Return where they are."""
        chi2, _, hold = self.normal
        return [
            Descent(chosen(self.arcs, k), float(chi2[k]), hold[k], bool(self.settled[k]))
            for k in range(len(chi2))
        ]

    def _at(self, arcs: Arc, which: IntArray) -> tuple[Normal, Array]:
        """Return normal equations and costs, infinite where no body is looked for."""
        count = len(which)
        normal = Normal(
            np.full(count, np.inf),
            np.zeros((count, UNKNOWNS)),
            np.zeros((count, UNKNOWNS, UNKNOWNS)),
        )
        sought = np.flatnonzero(_sought(arcs))
        total = np.full(count, np.inf)
        if len(sought):
            part, held = chosen(arcs, sought), Prior(*(p[which[sought]] for p in self.held))
            with np.errstate(over="ignore", invalid="ignore"):
                found = self.evidence.normal(course(part, self.evidence.times))
            found, cost = _with_prior(found, part.log_inertia, held)
            total[sought] = cost
            for whole, new in zip(normal, found):
                whole[sought] = new
        return normal, total


def covariance(hold: Array, fixed: int = 0) -> Array:
    """Covariance (11, 11) of information (11, 11); that of the first ``fixed`` unknowns is zero."""
    result = np.zeros_like(hold)
    free = slice(fixed, None)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hold)[free], np.finfo(float).tiny))
    both = scale[:, None] * scale
    result[free, free] = both * np.linalg.pinv(both * hold[free, free], 1e-15, hermitian=True)
    return result


def costs(evidence: Evidence, arcs: Arc) -> Array:
    """Return chi-squares (arc,) with the wide prior, infinite where no body is looked for."""
    if isinstance(evidence, KnownPoints) and compiled.available():
        from debrisest.batch import descent_loops

        told = evidence.times - arcs.epoch, evidence.loop_sums
        return descent_loops.costs(*told, arcs[1:], for_loops())
    result = np.full(len(arcs.q), np.inf)
    sought = np.flatnonzero(_sought(arcs))
    if len(sought):
        part = chosen(arcs, sought)
        with np.errstate(over="ignore", invalid="ignore"):
            chi2 = evidence.chi2(*along(part, evidence.times))
        result[sought] = chi2 + np.sum(part.log_inertia**2, axis=-1) / PRIOR_SIGMA**2
    return np.where(np.isfinite(result), result, np.inf)


def _with_prior(normal: Normal, log_inertia: Array, held: Prior) -> tuple[Normal, Array]:
    """Return normal equations with what else is held, and costs."""
    off = log_inertia - held.centre
    pulled = (held.information @ off[..., None])[..., 0]
    normal.pull[:, INERTIA] -= log_inertia * PRIOR_SIGMA**-2 + pulled
    normal.hold[:, INERTIA, INERTIA] += PRIOR_SIGMA**-2 * np.eye(5) + held.information
    wide = np.sum(log_inertia**2, axis=-1) / PRIOR_SIGMA**2
    total = normal.chi2 + wide + np.sum(off * pulled, axis=-1)
    return normal, np.where(np.isfinite(total), total, np.inf)


def _sought(arcs: Arc) -> BoolArray:
    return np.asarray(np.linalg.norm(arcs.log_inertia, axis=-1) < _WIDEST)


def _steps(normal: Normal, damping: Array, fixed: int) -> tuple[Array, Array]:
    """Steps (arc, 11), and by how much they should lower the chi-squares (arc,)."""
    free = slice(fixed, None)
    hold, pull = normal.hold[:, free, free], normal.pull[:, free]
    scale = np.maximum(np.diagonal(hold, 0, -2, -1), np.finfo(float).tiny) ** -0.5
    scaled = scale[:, :, None] * hold * scale[:, None, :]
    scaled += damping[:, None, None] * np.eye(scale.shape[-1])
    step = np.zeros_like(normal.pull)
    step[:, free] = scale * np.linalg.solve(scaled, (scale * pull)[..., None])[..., 0]
    bent = (hold @ step[:, free, None])[..., 0]
    return step, np.sum(step[:, free] * (2.0 * pull - bent), axis=-1)
