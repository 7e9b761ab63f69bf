"""The spread of a fit whose chi-square bends.

Along a direction of the inertia that the data hardly show, the valley of the chi-square bends, and
rises otherwise than a parabola: the second derivative at its floor tells neither how wide it is nor
where the other unknowns go. So where three sigma along a straight line do not cost nine, the floor
is followed to where they do, to both sides.

The directions follow each other: the floor along one is that at given inertia along all that are
known less. Else it would run off along these, whose own floors say the same again.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.arc import INERTIA, UNKNOWNS, Arc, displaced, stacked
from debrisest.batch.descent import PRIOR_SIGMA, Descent, Prior, costs, descend_all
from debrisest.batch.evidence import Evidence
from debrisest.batch.observability import inertia_directions
from debrisest.batch.spread import FAR, Sides, Spread, principal_ways, shift, unbent

_OTHERS = slice(0, 6)
_NARROW = 0.01  # of the best direction's sigma
_STRAIGHT = 0.1  # of nine, by which a straight line may cost more or less
_ENOUGH, _TOO_MUCH = 0.6, 1.7  # of nine, where the floor has been followed far enough
_TRIES = 8
_ITERATIONS = 40
_NEAR = 0.1  # sigmas, of a direction, over which nothing bends
_GAIN = 0.02  # of nine, by which the floor may be missed: a hundredth of a sigma's square
_FIRM = 1e-3  # sigma with which a point of the valley is held, in sigmas of the direction


def spread_of(evidence: Evidence, found: Descent, covariance: Array) -> Spread:
    """Return where the arc may be, from the ``covariance (11, 11)`` at its place.

    The errors of one sigma are five along the directions of the inertia, each with what the other
    unknowns do on the floor, and six at a given inertia.
    """
    valley = _Valley(evidence, found, covariance)
    rest = (covariance - valley.ways.T @ valley.ways)[_OTHERS, _OTHERS]
    others = np.pad(principal_ways(rest), ((0, 0), (0, 5)))
    axes = np.concatenate([others, valley.ways])
    sides = Sides.straight(found.arc, axes)
    bent = valley.bent()
    if not bent:
        return unbent(found.arc, sides)
    for way, both in zip(bent, valley.followed(bent)):
        sides = sides.replaced(len(axes) - 5 + way, *both)
    ends = sides.chosen([len(axes) - 5 + way for way in bent])
    return Spread(sides, *valley.twists(sides, bent), ends, valley.begins(ends, bent))


class _Valley:
    """The chi-square about an arc, along the directions of the inertia."""

    def __init__(self, evidence: Evidence, found: Descent, covariance: Array) -> None:
        self.evidence, self.arc = evidence, found.arc
        self.lowest = costs(evidence, stacked([found.arc]))[0]
        self.sigma, self.directions = inertia_directions(covariance)
        per_sigma = self.directions / np.maximum(self.sigma, np.finfo(float).tiny)
        self.ways = (covariance[:, INERTIA] @ per_sigma).T

    def rises(self, arcs: Arc) -> Array:
        """Return by how much arcs cost more than the best (arc,)."""
        return np.asarray(costs(self.evidence, arcs) - self.lowest)

    def bent(self) -> list[int]:
        """Return directions along which the cost at a side is not that of a parabola.

        Squares of their sigma are not far below the sigma of the best.
        """
        ways = np.flatnonzero(self.sigma**2 > _NARROW * self.sigma[0])
        both = np.array([[FAR], [-FAR]]) * self.ways[ways, None]
        ends = displaced(self.arc, both.reshape(-1, UNKNOWNS))
        off = np.abs(self.rises(ends) / FAR**2 - 1.0).reshape(-1, 2)
        return [int(way) for way in ways[np.any(off > _STRAIGHT, axis=1)]]

    def floors(self, starts: Sequence[Arc], ways: Sequence[int]) -> list[Arc]:
        """Return the best arcs, the inertia of each held along a direction and all worse ones."""
        firm = self.directions / (_FIRM * self.sigma)
        held = [firm[:, way:] for way in ways]
        priors = [Prior(arc.log_inertia, one @ one.T) for arc, one in zip(starts, held)]
        return [end.arc for end in descend_all(self.evidence, starts, _ITERATIONS, priors, _GAIN)]

    def followed(self, bent: list[int]) -> list[tuple[tuple[Arc, float], tuple[Arc, float]]]:
        """Return both ends of the floor along directions, and how many sigmas these are away."""
        scouts = [_Scout(self, way, sign) for way in bent for sign in (1.0, -1.0)]
        for _ in range(_TRIES):
            going = [scout for scout in scouts if not scout.there]
            if not going:
                break
            ends = self.floors([scout.start() for scout in going], [scout.way for scout in going])
            for scout, end, rise in zip(going, ends, self.rises(stacked(ends))):
                scout.judge(end, float(rise) / FAR**2)
        reached = [scout.reached() for scout in scouts]
        return list(zip(reached[::2], reached[1::2]))

    def begins(self, ends: Sides, bent: list[int]) -> Sides:
        """Return how directions begin that have these ends, with as much of a sigma along them."""
        half = ends.moved(self.arc)[0][:, INERTIA]
        share = np.sum(half.T * self.directions[:, bent], axis=0) / self.sigma[bent]
        near = Sides.straight(self.arc, _NEAR / FAR * self.ways[bent])
        return near._replace(far=np.tile(_NEAR / share, (2, 1)))

    def twists(self, sides: Sides, bent: list[int]) -> tuple[Sides, Sides]:
        """Return the floor half way between two bent directions, and across."""
        ends = [shift(self.arc, side)[-5:] for side in (sides.ahead, sides.behind)]
        return self._between(bent, ends, ends), self._between(bent, ends, ends[::-1])

    def _between(self, bent: list[int], ends: list[Array], others: list[Array]) -> Sides:
        pairs = [list(pair) for pair in combinations(bent, 2)]
        if not pairs:
            return Sides.straight(self.arc, np.zeros((0, 11)))
        one, two = np.transpose(pairs)
        errors = [np.sqrt(0.5) * (end[one] + other[two]) for end, other in zip(ends, others)]
        starts = [displaced(self.arc, error) for error in np.concatenate(errors)]
        found = self.floors(starts, [first for first, _ in pairs * 2])
        far = np.sqrt(np.maximum(self.rises(stacked(found)), FAR)).reshape(2, -1)
        return Sides(stacked(found[: len(pairs)]), stacked(found[len(pairs) :]), far)


class _Scout:
    """A search along the floor for where it has risen by about nine, or leaves all bodies."""

    def __init__(self, valley: _Valley, way: int, sign: float) -> None:
        self.way, self.step = way, sign * valley.ways[way]
        self.spread = PRIOR_SIGMA / valley.sigma[way]
        self.near, self.begin, self.above = 0.0, valley.arc, np.inf
        self.far = min(FAR, FAR * self.spread)
        self.there = False

    def start(self) -> Arc:
        """Return where to look for the floor next."""
        return displaced(self.begin, (self.far - self.near) * self.step)

    def judge(self, end: Arc, share: float) -> None:
        """Take the floor there, which has risen by a share of nine, for the end, or go on."""
        self.end, self.share = end, share
        farthest = FAR * self.spread
        if share > _TOO_MUCH:
            self.above, self.far = self.far, 0.5 * (self.near + self.far)
        elif share < _ENOUGH and self.far < farthest:
            self.near, self.begin = self.far, end
            self.far = min(2.0 * self.far, farthest, 0.5 * (self.far + self.above))
        else:
            self.there = True

    def reached(self) -> tuple[Arc, float]:
        """Return the end, and how many sigmas it is away."""
        return self.end, max(FAR * np.sqrt(max(self.share, 0.0)), self.far / self.spread)
