"""From a start to the whole span: windows that grow both ways, cleaned of outliers on the way."""

from typing import NamedTuple, TypeVar

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray
from debrisest.batch.acceptance import Fit, tested
from debrisest.batch.arc import Arc, along, course, moved
from debrisest.batch.descent import NOTHING_ELSE, Descent, Prior, covariance, descend, for_loops
from debrisest.batch.evidence import Evidence
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.starts import Start

_SURE_TURN = 0.35  # rad, sigma of the attitude up to which a window may grow at once
_LEAST_GROWTH, _MOST_GROWTH = 0.25, 1.0  # of the window's length, to each side
_STEPS = 7
_WILD = 2.0  # chi2/dof of a window, in units of the noise, that has gone wrong
_LARGEST_NOISE = 3.0  # times what was said, above which it is no noise
_WIDER = 1.2  # by how much chi2/dof may grow with more points
_GATE = 25.0  # normalised square, three degrees of freedom: once in 60 000 points
_ROUNDS = 4
_ITERATIONS = 12
_ENOUGH_EPOCHS = 150  # at least, of a window on the way
_TAME, _WILD_SHARE = 0.8, 4.0  # share of a prediction's squares, and how many times it is wild
_MEDIAN = 2.37  # of a chi-square of three
_UNUSUAL = 2.0  # median square above which outliers have drawn the fit, and the gate opens

AnyEvidence = TypeVar("AnyEvidence", bound=Evidence)


class Growth(NamedTuple):
    """How far a start has come."""

    found: Descent
    fit: Fit
    evidence: Evidence
    """Of the last window, less what the gates have rejected."""
    span: tuple[float, float]
    """Of the last window, s."""
    whole: bool
    """Whether the last window is the whole span and was not left."""

    @property
    def explains(self) -> bool:
        """Whether the arc stands all tests over the whole span."""
        return self.whole and self.fit.steady and self.fit.noise_below


def grow(evidence: Evidence, start: Start, half: float, noise: float = 1.0) -> Growth:
    """Return the fit of the longest window that an arc, true about its epoch, explains.

    ``noise`` is the factor by which that of single epochs exceeds what was said. On the way some
    hundred epochs of a window are enough, and the inertia is held as the start has it; the whole
    span counts all by itself, from its middle, where the information is rounder.
    """
    arc, held = start
    first, last = float(evidence.times[0]), float(evidence.times[-1])
    low, high = arc.epoch - half, arc.epoch + half
    good: Growth | None = None
    while True:
        whole = low <= first and high >= last
        arc = moved(arc, 0.5 * (first + last)) if whole else arc
        found, kept = _fitted(evidence.within(_chosen(evidence, low, high, whole)), arc, held)
        if whole:
            found, kept = _fitted(kept, found.arc)
        fit = tested(kept, found.arc)
        now = Growth(found, fit, kept, (max(low, first), min(high, last)), whole)
        if fit.excess > _WILD * np.clip(noise, 1.0, _LARGEST_NOISE) ** 2 and not (
            fit.steady and good is None
        ):
            return (good or now)._replace(whole=False)
        if whole:
            return now
        good, arc = now, found.arc
        low, high = _wider(evidence, found, low, high)


def _chosen(evidence: Evidence, low: float, high: float, every: bool) -> BoolArray:
    """Return which epochs (time,) of a window count: all, or some that are spread over it."""
    chosen = np.zeros(len(evidence.times), dtype=bool)
    inside = np.flatnonzero((evidence.times >= low) & (evidence.times <= high))
    chosen[inside[:: 1 if every else max(len(inside) // _ENOUGH_EPOCHS, 1)]] = True
    return chosen


def refitted(evidence: Evidence, arc: Arc) -> Growth:
    """Return the fit of the whole span from an arc that is almost right."""
    first, last = float(evidence.times[0]), float(evidence.times[-1])
    found, kept = _fitted(evidence, moved(arc, 0.5 * (first + last)))
    return Growth(found, tested(kept, found.arc), kept, (first, last), True)


def widened(growth: Growth, wider: Evidence) -> Growth:
    """Return the fit of more evidence over the same span, unless it disagrees."""
    found, kept = _fitted(wider, growth.found.arc)
    fit = tested(kept, found.arc)
    agrees = fit.steady and fit.excess < max(_WIDER, _WIDER * growth.fit.excess)
    return growth._replace(found=found, fit=fit, evidence=kept) if agrees else growth


def _fitted(
    window: AnyEvidence, arc: Arc, held: Prior = NOTHING_ELSE
) -> tuple[Descent, AnyEvidence]:
    """Return the fit of a window, first with all points, then without outliers."""
    if isinstance(window, KnownPoints) and compiled.available():
        found, weight = _by_loops(window, arc, held)
        return found, window.weighed(weight)
    kept = _without_wild(window, arc)
    found = descend(kept, arc, _ITERATIONS, held)
    for _ in range(_ROUNDS):
        q, rate = along(found.arc, window.times)
        squares = window.squares(q, rate)
        limit = _GATE * max(1.0, float(np.nanmedian(squares)) / _MEDIAN / _UNUSUAL)
        gated = window.gated(q, rate, limit) if np.any(squares > limit) else window
        if limit == _GATE and np.array_equal(gated.dof, kept.dof):
            break
        kept = gated
        found = descend(kept, found.arc, _ITERATIONS, held)
    return found, kept


def _by_loops(window: KnownPoints, arc: Arc, held: Prior) -> tuple[Descent, Array]:
    """Return the fit, and the weights of the points that are left, by compiled loops."""
    from debrisest.batch.window_loops import fitted

    gates = _GATE, _ROUNDS, _TAME, _WILD_SHARE, _MEDIAN * _UNUSUAL
    q, rate, logs = (np.array(part) for part in arc[1:])
    told = window.times - arc.epoch, *window.for_loops
    prior = held.centre, held.information
    chi2, settled, hold, weight = fitted(
        *told, (q, rate, logs), prior, for_loops(), _ITERATIONS, gates
    )
    return Descent(Arc(arc.epoch, q, rate, logs), chi2, hold, settled), weight


def _without_wild(window: AnyEvidence, arc: Arc) -> AnyEvidence:
    """Return a window less what is far from the prediction, by the prediction's own errors."""
    predicted = along(arc, window.times)
    squares = window.squares(*predicted)
    limit = _GATE + _WILD_SHARE * float(np.nanquantile(squares, _TAME))
    return window.gated(*predicted, limit) if np.any(squares > limit) else window


def _wider(evidence: Evidence, found: Descent, low: float, high: float) -> tuple[float, float]:
    """Return the next window: as much longer as the attitude is predicted well enough."""
    length = min(high, evidence.times[-1]) - max(low, evidence.times[0])
    steps = np.linspace(_LEAST_GROWTH, _MOST_GROWTH, _STEPS) * length
    before, after = max(low, evidence.times[0]) - steps, min(high, evidence.times[-1]) + steps
    derivative = course(found.arc, np.concatenate([before, after])).turn_by
    spread = covariance(found.hold, evidence.unknowns_fixed)
    turn = derivative @ spread @ np.swapaxes(derivative, -1, -2)
    sure = np.sqrt(np.linalg.eigvalsh(turn)[:, -1]).reshape(2, _STEPS) < _SURE_TURN
    below, above = (max(int(np.sum(np.cumprod(side))) - 1, 0) for side in sure)
    return float(before[below]), float(after[above])
