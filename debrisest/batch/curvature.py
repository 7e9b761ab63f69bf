"""The spread of a fit whose chi-square bends.

Along a direction of the inertia that the data hardly show, the valley of the chi-square bends, and
rises otherwise than a parabola: the second derivative at its floor tells neither how wide it is nor
where the other unknowns go. So where three sigma along a straight line do not cost nine, the floor
is followed to where they do, to both sides.

The directions follow each other: the floor along one is that at given inertia along all that are
known less. Else it would run off along these, whose own floors say the same again.
"""

from itertools import combinations

import numpy as np

from debrisest.arrays import Array
from debrisest.batch.arc import INERTIA, Arc, displaced
from debrisest.batch.descent import PRIOR_SIGMA, Descent, Prior, cost, descend
from debrisest.batch.evidence import Evidence
from debrisest.batch.observability import inertia_directions
from debrisest.batch.spread import FAR, Sides, Spread, principal_ways, shift, stacked

_OTHERS = slice(0, 6)
_NARROW = 0.01  # of the best direction's sigma
_STRAIGHT = 0.1  # of nine, by which a straight line may cost more or less
_ENOUGH, _TOO_MUCH = 0.6, 1.7  # of nine, where the floor has been followed far enough
_TRIES = 8
_ITERATIONS = 40
_NEAR = 0.1  # sigmas, of a direction, over which nothing bends
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
    bent = [way for way in range(5) if valley.may_bend(way) and valley.bends(way)]
    for way in bent:
        sides = sides.replaced(len(axes) - 5 + way, *valley.followed(way))
    ends = sides.chosen([len(axes) - 5 + way for way in bent])
    return Spread(sides, *valley.twists(sides, bent), ends, valley.begins(ends, bent))


class _Valley:
    """The chi-square about an arc, along the directions of the inertia."""

    def __init__(self, evidence: Evidence, found: Descent, covariance: Array) -> None:
        self.evidence, self.arc = evidence, found.arc
        self.lowest = cost(evidence, found.arc)
        self.sigma, self.directions = inertia_directions(covariance)
        per_sigma = self.directions / np.maximum(self.sigma, np.finfo(float).tiny)
        self.ways = (covariance[:, INERTIA] @ per_sigma).T

    def rise(self, arc: Arc) -> float:
        """Return by how much an arc costs more than the best."""
        return cost(self.evidence, arc) - self.lowest

    def may_bend(self, way: int) -> bool:
        """Return whether squares of a direction's sigma are not far below the sigma of the best."""
        return bool(self.sigma[way] ** 2 > _NARROW * self.sigma[0])

    def bends(self, way: int) -> bool:
        """Return whether the costs at both sides are not those of a parabola."""
        ends = (displaced(self.arc, sign * FAR * self.ways[way]) for sign in (1.0, -1.0))
        return any(abs(self.rise(end) / FAR**2 - 1.0) > _STRAIGHT for end in ends)

    def floor(self, start: Arc, way: int) -> Arc:
        """Return the best arc with the inertia held along a direction and all that are worse."""
        held = self.directions[:, way:] / (_FIRM * self.sigma[way:])
        return descend(
            self.evidence, start, _ITERATIONS, Prior(start.log_inertia, held @ held.T)
        ).arc

    def followed(self, way: int) -> tuple[tuple[Arc, float], tuple[Arc, float]]:
        """Return both ends of the floor along a direction, and how many sigmas these are away."""
        return self._end(way, 1.0), self._end(way, -1.0)

    def _end(self, way: int, sign: float) -> tuple[Arc, float]:
        """Return where the floor has risen by about nine, or leaves what a body can be."""
        farthest = FAR * PRIOR_SIGMA / self.sigma[way]
        near, begin, above = 0.0, self.arc, np.inf
        far = min(FAR, farthest)
        for _ in range(_TRIES):
            start = displaced(begin, sign * (far - near) * self.ways[way])
            end = self.floor(start, way)
            share = self.rise(end) / FAR**2
            if share > _TOO_MUCH:
                above = far
                far = 0.5 * (near + far)
            elif share < _ENOUGH and far < farthest:
                near, begin = far, end
                far = min(2.0 * far, farthest, 0.5 * (far + above))
            else:
                break
        least = far * self.sigma[way] / PRIOR_SIGMA
        return end, max(FAR * np.sqrt(max(share, 0.0)), least)

    def begins(self, ends: Sides, bent: list[int]) -> Sides:
        """Return how directions begin that have these ends, with as much of a sigma along them."""
        half = ends.moved(self.arc)[0][:, INERTIA]
        share = np.sum(half.T * self.directions[:, bent], axis=0) / self.sigma[bent]
        near = Sides.straight(self.arc, _NEAR / FAR * self.ways[bent])
        return near._replace(far=np.tile(_NEAR / share, (2, 1)))

    def twists(self, sides: Sides, bent: list[int]) -> tuple[Sides, Sides]:
        """Return the floor half way between two bent directions, and across."""
        return self._between(sides, bent, 1.0), self._between(sides, bent, -1.0)

    def _between(self, sides: Sides, bent: list[int], sign: float) -> Sides:
        half = np.sqrt(0.5)
        result = Sides.straight(self.arc, np.zeros((0, 11)))
        ends = shift(self.arc, sides.ahead)[-5:], shift(self.arc, sides.behind)[-5:]
        for first, second in combinations(bent, 2):
            pairs = (ends[0][second], ends[1][second])[:: int(sign)]
            starts = [displaced(self.arc, half * (ends[k][first] + pairs[k])) for k in (0, 1)]
            found = [self.floor(start, first) for start in starts]
            far = [np.sqrt(max(self.rise(end), FAR)) for end in found]
            both = stacked(found[:1]), stacked(found[1:])
            result = result.joined(Sides(*both, np.array(far)[:, None]))
        return result
