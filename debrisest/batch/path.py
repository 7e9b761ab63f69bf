"""Attitude and rate at given times, with covariances."""

from typing import NamedTuple, Self

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import RATE, TURN, UNKNOWNS, Arc, along, joined, stacked
from debrisest.batch.spread import Spread, halved


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
    joint: Array
    """Of attitude, rate and inertia (time, 11, 11), NaN without a law of motion."""

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
    q, rate, joint = (_by_loops if compiled.available() else _by_numpy)(arc, spread, times)
    return Path(times, q, rate, joint[:, TURN, TURN], joint[:, RATE, RATE], joint)


def _by_numpy(arc: Arc, spread: Spread, times: Array) -> tuple[Array, Array, Array]:
    """Attitudes, rates and joint covariance."""
    sides = spread.sides
    q, rates = along(joined(stacked([arc]), *sides), times)
    turns = quaternion.log(quaternion.multiply(q[1:], quaternion.conjugate(q[0])))
    inertias = np.concatenate([side.log_inertia - arc.log_inertia for side in sides])
    constant = np.broadcast_to(inertias[:, None], (*turns.shape[:2], 5))
    errors = np.concatenate([turns, rates[1:] - rates[0], constant], axis=-1)
    ends = np.split(errors, np.cumsum([len(side.q) for side in sides])[:-1])
    moved = [halved(ends[2 * k], ends[2 * k + 1], part.far) for k, part in enumerate(spread)]
    ways = np.moveaxis(spread.ways(moved), 0, 1)
    return q[0], rates[0], np.asarray(np.swapaxes(ways, -1, -2) @ ways)


def _by_loops(arc: Arc, spread: Spread, times: Array) -> tuple[Array, Array, Array]:
    """The same by compiled loops."""
    from debrisest.batch.path_loops import path

    q, rate, joint = path(times - arc.epoch, *spread.for_loops(arc))
    return np.ascontiguousarray(q.T), np.ascontiguousarray(rate.T), joint


def unknown_path(times: Array) -> Path:
    """Return a path of which nothing is known."""
    shapes = ((4,), (3,), (3, 3), (3, 3), (UNKNOWNS, UNKNOWNS))
    return Path(times, *(np.full((len(times), *shape), np.nan) for shape in shapes))
