"""Attitude and rate at given times, with covariances."""

from typing import NamedTuple, Self

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import Arc, Course, along, course, displaced

_FOURTH_MOMENT = 3.0  # of a Gaussian: mean square of a square


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
    """Return torque-free motion at ``times``, with the ``covariance (11, 11)`` of its unknowns.

    With the second order of what one sigma along each axis of the covariance does: the size of a
    rate may be known far better than its direction, and errors then lie on a sphere, not a plane.
    """
    motion = course(arc, times)
    linear = (motion.turn_by, motion.rate_by)
    turn, rate = (
        by @ covariance @ np.swapaxes(by, -1, -2) + _FOURTH_MOMENT * bend
        for by, bend in zip(linear, _bends(arc, covariance, motion, times))
    )
    return Path(times, motion.q, motion.rate, turn, rate)


def _bends(arc: Arc, covariance: Array, motion: Course, times: Array) -> tuple[Array, Array]:
    """Squares (time, 3, 3) of the second order of attitude and rate."""
    scale = np.sqrt(np.maximum(np.diag(covariance), np.finfo(float).tiny))
    values, axes = np.linalg.eigh(covariance / scale[:, None] / scale)
    sides = (scale[:, None] * axes * np.sqrt(np.maximum(values, 0.0))).T
    q, rate = along(displaced(arc, np.concatenate([sides, -sides])), times)
    turn = quaternion.log(quaternion.multiply(q, quaternion.conjugate(motion.q)))
    count = len(sides)
    bends = (0.5 * (off[:count] + off[count:]) for off in (turn, rate - motion.rate))
    of_turn, of_rate = (np.einsum("kti,ktj->tij", bend, bend) for bend in bends)
    return of_turn, of_rate


def unknown_path(times: Array) -> Path:
    """Return a path of which nothing is known."""
    shapes = ((4,), (3,), (3, 3), (3, 3))
    return Path(times, *(np.full((len(times), *shape), np.nan) for shape in shapes))
