"""Measured attitudes as evidence: poses of a network, of a perspective solver, of markers."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import Course
from debrisest.batch.evidence import Epochs, Normal, Seen, Told, summed


@dataclass(frozen=True)
class Attitudes:
    """Evidence of ``q_if (time, 4)``, of either sign, with information in inertial axes."""

    times: Array
    q: Array
    information: Array
    """(time, 3, 3), 1/rad^2, zero where nothing counts."""
    of_rate = False
    unknowns_fixed = 0

    @property
    def dof(self) -> Array:
        """Three for each attitude that counts (time,)."""
        return np.asarray(3.0 * self.information.any(axis=(-2, -1)))

    def told(self, q: Array, rate: Array, epochs: Epochs = slice(None)) -> Told:
        """Return what the epochs say at attitudes (..., 4)."""
        turn = quaternion.log(quaternion.multiply(self.q[epochs], quaternion.conjugate(q)))
        hold = self.information[epochs]
        pull = (hold @ turn[..., None])[..., 0]
        chi2 = np.sum(pull * turn, axis=-1)
        return Told(chi2, pull, np.broadcast_to(hold, (*chi2.shape, 3, 3)))

    def normal(self, course: Course) -> Normal:
        """Return the normal equations at the motion."""
        return summed(self.told(course.q, course.rate), course.turn_by)

    def chi2(self, q: Array, rate: Array) -> float:
        """Return the chi-square of all epochs."""
        return float(self.told(q, rate).chi2.sum())

    def within(self, epochs: BoolArray) -> Self:
        """Return the evidence of some epochs."""
        return type(self)(self.times[epochs], self.q[epochs], self.information[epochs])

    def settled(self, q: Array) -> Self:
        """Return itself: it has no nuisances."""
        return self

    def seen(self) -> Seen:
        """Return the attitudes themselves."""
        return Seen(np.where(self.dof[:, None] > 0.0, self.q, np.nan), self.information)

    def squares(self, q: Array, rate: Array) -> Array:
        """Return the chi-square of each epoch (time,), NaN where nothing counts."""
        return np.where(self.dof > 0.0, self.told(q, rate).chi2, np.nan)

    def gated(self, q: Array, rate: Array, limit: float) -> Self:
        """Return it without attitudes off by more than ``limit``, unless half would go."""
        kept = self.told(q, rate).chi2 <= limit
        if kept.sum() < 0.5 * len(kept):
            return self
        information = np.where(kept[:, None, None], self.information, 0.0)
        return type(self)(self.times, self.q, information)

    def scaled(self, noise: float) -> Self:
        """Return it with all standard deviations multiplied by ``noise``."""
        return type(self)(self.times, self.q, self.information / noise**2)
