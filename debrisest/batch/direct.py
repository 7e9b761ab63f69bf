"""Evidence of three numbers measured at each epoch, whatever they are: attitudes or rates."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.batch.arc import Course
from debrisest.batch.evidence import Epochs, Normal, Seen, Told, summed


@dataclass(frozen=True)
class Direct(ABC):
    """Values that were measured, with information about their errors; there are no nuisances."""

    times: Array
    measured: Array
    """(time, ...)."""
    information: Array
    """(time, 3, 3), zero where nothing counts."""
    of_rate: ClassVar[bool]
    unknowns_fixed: ClassVar[int]

    @abstractmethod
    def errors(self, q: Array, rate: Array, epochs: Epochs) -> Array:
        """Return what is measured less the motion (..., 3)."""

    @abstractmethod
    def derivative(self, course: Course) -> Array:
        """Return the derivative of the motion (time, 3, 11) by the unknowns."""

    @abstractmethod
    def seen(self) -> Seen:
        """Return attitudes of single epochs."""

    @property
    def dof(self) -> Array:
        """Three for each epoch that counts (time,)."""
        return np.asarray(3.0 * self.information.any(axis=(-2, -1)))

    def told(self, q: Array, rate: Array, epochs: Epochs = slice(None)) -> Told:
        """Return what the epochs say at attitudes (..., 4) and rates (..., 3)."""
        error, hold = self.errors(q, rate, epochs), self.information[epochs]
        pull = (hold @ error[..., None])[..., 0]
        chi2 = np.sum(pull * error, axis=-1)
        return Told(chi2, pull, np.broadcast_to(hold, (*chi2.shape, 3, 3)))

    def normal(self, course: Course) -> Normal:
        """Return the normal equations at the motions."""
        return summed(self.told(course.q, course.rate), self.derivative(course))

    def chi2(self, q: Array, rate: Array) -> Array:
        """Return the chi-squares (...) of all epochs."""
        return np.asarray(self.told(q, rate).chi2.sum(axis=-1))

    def within(self, epochs: BoolArray) -> Self:
        """Return the evidence of some epochs."""
        return type(self)(self.times[epochs], self.measured[epochs], self.information[epochs])

    def settled(self, q: Array) -> Self:
        """Return itself: it has no nuisances."""
        return self

    def squares(self, q: Array, rate: Array) -> Array:
        """Return the chi-square of each epoch (time,), NaN where nothing counts."""
        return np.where(self.dof > 0.0, self.told(q, rate).chi2, np.nan)

    def gated(self, q: Array, rate: Array, limit: float) -> Self:
        """Return it without values off by more than ``limit``, unless half would go."""
        kept = self.told(q, rate).chi2 <= limit
        if kept.sum() < 0.5 * len(kept):
            return self
        information = np.where(kept[:, None, None], self.information, 0.0)
        return replace(self, information=information)

    def scaled(self, noise: float) -> Self:
        """Return it with all standard deviations multiplied by ``noise``."""
        return replace(self, information=self.information / noise**2)
