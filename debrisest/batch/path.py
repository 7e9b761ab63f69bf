"""Attitude and rate at given times, with covariances."""

from typing import NamedTuple, Self

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import Arc, along
from debrisest.batch.spread import Sides, Spread, halved

Halves = tuple[Array, Array]


class Path(NamedTuple):
    """Motion at times (time,), s; NaN where nothing is known."""

    times: Array
    q: Array
    """``q_if (time, 4)``."""
    rate: Array
    """In the feature frame (time, 3), rad/s."""
    turn_covariance: Array
    """Of the attitude, in inertial axes (time, 3, 3), rad^2."""
    rate_covariance: Array
    """(time, 3, 3), rad^2/s^2."""

    @property
    def turn_sigma(self) -> Array:
        """Standard deviations of the attitude (time, 3), rad."""
        return np.asarray(np.sqrt(np.diagonal(self.turn_covariance, 0, -2, -1)))

    @property
    def rate_sigma(self) -> Array:
        """Standard deviations of the rate (time, 3), rad/s."""
        return np.asarray(np.sqrt(np.diagonal(self.rate_covariance, 0, -2, -1)))

    def at(self, epochs: slice | IntArray | BoolArray) -> Self:
        """Return some of the times."""
        return type(self)(*(part[epochs] for part in self))


def path_of(arc: Arc, spread: Spread, times: Array) -> Path:
    """Return torque-free motion at ``times``, with what lies between the sides of a spread.

    Nothing is linearised: the size of a rate may be known far better than its direction, and
    errors then lie on a sphere, not on a plane.
    """
    q, rate = along(arc, times)
    turns, rates = zip(*(_moved(q, rate, sides, times) for sides in spread))
    return Path(times, q, rate, *(_covariance(*parts) for parts in (turns, rates)))


def _moved(q: Array, rate: Array, sides: Sides, times: Array) -> tuple[Halves, Halves]:
    """Halves and middles (axis, time, 3) of attitude and rate between the sides."""
    turns, rates = [], []
    for arcs in (sides.ahead, sides.behind):
        other, other_rate = along(arcs, times)
        turns.append(quaternion.log(quaternion.multiply(other, quaternion.conjugate(q))))
        rates.append(other_rate - rate)
    return halved(turns[0], turns[1], sides.far), halved(rates[0], rates[1], sides.far)


def _covariance(axes: Halves, along_both: Halves, across: Halves) -> Array:
    twist = 0.5 * (along_both[1] - across[1])
    ways = np.concatenate([*axes, twist])
    return np.asarray(np.einsum("kti,ktj->tij", ways, ways))


def unknown_path(times: Array) -> Path:
    """Return a path of which nothing is known."""
    shapes = ((4,), (3,), (3, 3), (3, 3))
    return Path(times, *(np.full((len(times), *shape), np.nan) for shape in shapes))
