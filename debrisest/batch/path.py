"""Attitude and rate at given times, with covariances."""

from typing import NamedTuple, Self

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.batch.arc import Arc, course


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


def path_of(arc: Arc, covariance: Array, times: Array) -> Path:
    """Return torque-free motion at ``times``, with the ``covariance (11, 11)`` of its unknowns."""
    motion = course(arc, times)
    turn, rate = (
        by @ covariance @ np.swapaxes(by, -1, -2) for by in (motion.turn_by, motion.rate_by)
    )
    return Path(times, motion.q, motion.rate, turn, rate)


def unknown_path(times: Array) -> Path:
    """Return a path of which nothing is known."""
    shapes = ((4,), (3,), (3, 3), (3, 3))
    return Path(times, *(np.full((len(times), *shape), np.nan) for shape in shapes))
