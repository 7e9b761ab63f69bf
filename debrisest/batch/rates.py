"""Measured body rates as evidence: a gyro, or a network that tells rates.

No attitude is measured: that of the arc's epoch names the inertial axes and is fixed.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import Course
from debrisest.batch.evidence import Epochs, Normal, Seen, Told, summed


@dataclass(frozen=True)
class Rates:
    """Evidence of rates (time, 3), rad/s, with information in the body's axes."""

    times: Array
    rate: Array
    information: Array
    """(time, 3, 3), s^2/rad^2, zero where nothing counts."""
    of_rate = True
    unknowns_fixed = 3

    @property
    def dof(self) -> Array:
        """Three for each rate that counts (time,)."""
        return np.asarray(3.0 * self.information.any(axis=(-2, -1)))

    def told(self, q: Array, rate: Array, epochs: Epochs = slice(None)) -> Told:
        """Return what the epochs say at rates (..., 3)."""
        error, hold = self.rate[epochs] - rate, self.information[epochs]
        pull = (hold @ error[..., None])[..., 0]
        chi2 = np.sum(pull * error, axis=-1)
        return Told(chi2, pull, np.broadcast_to(hold, (*chi2.shape, 3, 3)))

    def normal(self, course: Course) -> Normal:
        """Return the normal equations at the motion."""
        return summed(self.told(course.q, course.rate), course.rate_by)

    def chi2(self, q: Array, rate: Array) -> float:
        """Return the chi-square of all epochs."""
        return float(self.told(q, rate).chi2.sum())

    def within(self, epochs: BoolArray) -> Self:
        """Return the evidence of some epochs."""
        return type(self)(self.times[epochs], self.rate[epochs], self.information[epochs])

    def settled(self, q: Array) -> Self:
        """Return itself: it has no nuisances."""
        return self

    def seen(self) -> Seen:
        """Return attitudes as the rates add up to them, from the first epoch on.

        Their information stands for the noise of a rate over one step; the drift does not matter
        to windows, whose attitude is compared with that of their middle.
        """
        step = np.diff(self.times)
        middle = 0.5 * (self.rate[1:] + self.rate[:-1])
        turns = quaternion.exp(middle * step[:, None])
        q = np.empty((len(self.times), 4))
        q[:1] = (1.0, 0.0, 0.0, 0.0)
        for k, turn in enumerate(turns):
            q[k + 1] = quaternion.multiply(q[k], turn)
        typical = np.median(step) if len(step) else 1.0
        return Seen(q, self.information / typical**2)

    def squares(self, q: Array, rate: Array) -> Array:
        """Return the chi-square of each epoch (time,), NaN where nothing counts."""
        return np.where(self.dof > 0.0, self.told(q, rate).chi2, np.nan)

    def gated(self, q: Array, rate: Array, limit: float) -> Self:
        """Return it without rates off by more than ``limit``, unless half would go."""
        kept = self.told(q, rate).chi2 <= limit
        if kept.sum() < 0.5 * len(kept):
            return self
        information = np.where(kept[:, None, None], self.information, 0.0)
        return type(self)(self.times, self.rate, information)

    def scaled(self, noise: float) -> Self:
        """Return it with all standard deviations multiplied by ``noise``."""
        return type(self)(self.times, self.rate, self.information / noise**2)
