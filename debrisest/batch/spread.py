"""How far an arc may be off, as motions to both sides of it.

Least squares that bend have no covariance that holds at all times and for all quantities. So each
axis of the errors is told by two arcs some sigmas away to either side, each of which explains the
data as well as its number of sigmas says. What lies between them follows, in whatever quantity, at
whatever time: half their difference, and how far their middle is off.
"""

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import Arc, chosen, displaced, joined, stacked

FAR = 3.0
"""Sigmas at which the sides are looked for: what is claimed within three holds within three."""


class Sides(NamedTuple):
    """Two arcs for each axis of the errors."""

    ahead: Arc
    """Of each axis (axis, ...)."""
    behind: Arc
    far: Array
    """How many sigmas these are away (2, axis)."""

    @classmethod
    def straight(cls, arc: Arc, axes: Array) -> Self:
        """Return sides at `FAR` times the ``axes (axis, 11)``, of one sigma each."""
        far = np.full((2, len(axes)), FAR)
        return cls(displaced(arc, FAR * axes), displaced(arc, -FAR * axes), far)

    def replaced(self, axis: int, ahead: tuple[Arc, float], behind: tuple[Arc, float]) -> Self:
        """Return the sides with others, and how far they are, along one axis."""
        far = self.far.copy()
        far[:, axis] = ahead[1], behind[1]
        return type(self)(
            _with(self.ahead, axis, ahead[0]), _with(self.behind, axis, behind[0]), far
        )

    def chosen(self, axes: list[int]) -> Self:
        """Return the sides of some axes."""
        ahead, behind = (chosen(arcs, axes) for arcs in self[:2])
        return type(self)(ahead, behind, self.far[:, axes])

    def moved(self, arc: Arc) -> tuple[Array, Array]:
        """Return half the way between the sides (axis, 11) and its middle, per sigma."""
        return halved(shift(arc, self.ahead), shift(arc, self.behind), self.far)


class Spread(NamedTuple):
    """All axes of an arc's errors, what two of them do together, and what one does on its way."""

    axes: Sides
    along: Sides
    """Half way between two axes (pair, ...), and across: half way between one and the other's
    behind."""
    across: Sides
    ends: Sides
    """Those of the axes that bend (bent, ...), and how these begin at the arc: an axis that bends
    like an S does not lie on the line between its ends."""
    begins: Sides

    def covariance(self, arc: Arc) -> Array:
        """Return that of the errors of the unknowns (11, 11)."""
        if compiled.available():
            from debrisest.batch.path_loops import path

            return np.asarray(path(np.zeros(1), *self.for_loops(arc))[2][0])
        ways = self.ways([sides.moved(arc) for sides in self])
        return np.asarray(ways.T @ ways)

    @property
    def sides(self) -> list[Arc]:
        """Return the arcs ahead and behind, part by part."""
        return [side for part in self for side in (part.ahead, part.behind)]

    def for_loops(self, arc: Arc) -> tuple[tuple[Array, Array, Array], Array, IntArray]:
        """Return what `path_loops` take of an arc with this spread."""
        arcs = joined(stacked([arc]), *self.sides)
        far = np.concatenate([[0.0], *(part.far.ravel() for part in self)])
        axes = np.array([part.far.shape[1] for part in self])
        return (arcs.q, arcs.rate, arcs.log_inertia), far, axes

    @staticmethod
    def ways(moved: Sequence[tuple[Array, Array]]) -> Array:
        """Return independent errors (way, ..., n) of one sigma each, as all sides have moved."""
        axes, along, across, ends, begins = moved
        return np.concatenate([*axes, 0.5 * (along[1] - across[1]), ends[0] - begins[0]])


def straight(arc: Arc, covariance: Array) -> Spread:
    """Return the spread of a ``covariance (11, 11)`` that bends nowhere."""
    return unbent(arc, Sides.straight(arc, principal_ways(covariance)))


def unbent(arc: Arc, axes: Sides) -> Spread:
    """Return the spread of axes of which none bends."""
    no_arc = Arc(arc.epoch, *(np.zeros((0, len(part))) for part in arc[1:]))
    none = Sides(no_arc, no_arc, np.zeros((2, 0)))
    return Spread(axes, none, none, none, none)


def principal_ways(covariance: Array) -> Array:
    """Return independent errors (axis, n) of one sigma each, whatever the units."""
    scale = np.sqrt(np.maximum(np.diag(covariance), np.finfo(float).tiny))
    values, axes = np.linalg.eigh(covariance / scale[:, None] / scale)
    return np.asarray((scale[:, None] * axes * np.sqrt(np.maximum(values, 0.0))).T)


def halved(ahead: Array, behind: Array, far: Array) -> tuple[Array, Array]:
    """Return half of the way (axis, ..., n) from behind to ahead and its middle, per sigma."""
    shape = (2, -1, *[1] * (ahead.ndim - 1))
    up, down = np.stack([ahead, behind]) / far.reshape(shape)
    return 0.5 * (up - down), 0.5 * (up + down)


def shift(arc: Arc, others: Arc) -> Array:
    """Return the errors (axis, 11) that take the arc to others."""
    turn = quaternion.log(quaternion.multiply(others.q, quaternion.conjugate(arc.q)))
    changes = others.rate - arc.rate, others.log_inertia - arc.log_inertia
    return np.concatenate([turn, *changes], axis=-1)


def _with(arcs: Arc, axis: int, arc: Arc) -> Arc:
    parts = [part.copy() for part in arcs[1:]]
    for part, new in zip(parts, arc[1:]):
        part[axis] = new
    return Arc(arcs.epoch, *parts)
