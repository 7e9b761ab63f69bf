"""From when to when torque-free motion explains data that it does not explain as a whole.

A slow torque hides in a fit of the whole span, whose blocks are then all a little off. So windows
that stand both tests are grown from several starts; the ends of the longest are found by halving.
"""

from dataclasses import dataclass

from debrisest.batch.acceptance import tested
from debrisest.batch.arc import Arc
from debrisest.batch.descent import descend
from debrisest.batch.evidence import Evidence
from debrisest.batch.local_rates import Local
from debrisest.batch.momentum_start import inertia_start
from debrisest.batch.starts import arc_of, best_windows

_HALVINGS = 5
_FEWEST_EPOCHS = 6
_WILD = 2.0  # chi2/dof, in units of the noise of single windows


def holding(evidence: Evidence, local: Local) -> tuple[float, float]:
    """Return the limits, s, of the longest window that stands the tests, from some starts."""
    inertia = inertia_start(local).centre
    windows = [_longest(evidence, arc_of(local, k, inertia), local) for k in best_windows(local)]
    return max(windows, key=lambda window: window[1] - window[0])


@dataclass
class _Window:
    """Data about an arc that explains them so far."""

    evidence: Evidence
    arc: Arc
    noise: float

    def reaches(self, low: float, high: float) -> bool:
        """Return whether an arc explains the data from one time to another; if so, keep it."""
        inside = (self.evidence.times >= low) & (self.evidence.times <= high)
        if inside.sum() < _FEWEST_EPOCHS:
            return False
        window = self.evidence.within(inside)
        found = descend(window, self.arc, 12)
        fit = tested(window, found.arc)
        stands = fit.steady and fit.excess < _WILD * max(self.noise, 1.0) ** 2
        self.arc = found.arc if stands else self.arc
        return stands


def _longest(evidence: Evidence, arc: Arc, local: Local) -> tuple[float, float]:
    first, last = float(evidence.times[0]), float(evidence.times[-1])
    low, high = max(arc.epoch - local.half, first), min(arc.epoch + local.half, last)
    window = _Window(evidence, arc, local.noise)
    if not window.reaches(low, high):
        return arc.epoch, arc.epoch
    while (low, high) != (first, last):
        more = 0.5 * (high - low)
        if not window.reaches(max(low - more, first), min(high + more, last)):
            break
        low, high = max(low - more, first), min(high + more, last)
    return _edge(window, low, first, high), _edge(window, high, last, low)


def _edge(window: _Window, inside: float, outside: float, other: float) -> float:
    """Return how far towards ``outside`` a window from ``other`` to ``inside`` can be led."""
    if window.reaches(*sorted((other, outside))):
        return outside
    for _ in range(_HALVINGS):
        middle = 0.5 * (inside + outside)
        if window.reaches(*sorted((other, middle))):
            inside = middle
        else:
            outside = middle
    return inside
