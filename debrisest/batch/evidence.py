"""What the epochs tell of attitude or rate, whatever was measured.

Start, descent, windows, acceptance and smoother know a measurement by its `Evidence` alone: a
chi-square of each epoch and its first and second derivative by three numbers, the error of the
attitude in inertial axes or the error of the rate in the feature frame.
"""

from typing import Any, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.batch.arc import Course

Epochs = slice | IntArray | BoolArray | int


class Told(NamedTuple):
    """What each epoch says of its three numbers ``x``: ``chi2 - 2 pull x + x hold x``."""

    chi2: Array
    """(...)."""
    pull: Array
    """(..., 3)."""
    hold: Array
    """Information (..., 3, 3)."""


class Normal(NamedTuple):
    """The same of the unknowns of arcs, summed over epochs."""

    chi2: Array
    """(...)."""
    pull: Array
    """(..., 11)."""
    hold: Array
    """(..., 11, 11)."""


class Seen(NamedTuple):
    """Attitudes of single epochs, where one epoch tells all three directions."""

    q: Array
    """``q_if (time, 4)``, NaN elsewhere."""
    information: Array
    """(time, 3, 3), in inertial axes."""


class Evidence(Protocol):
    """Measurements of one rigid body at ``times (time,)``, s."""

    @property
    def times(self) -> Array:
        """Times (time,), s."""

    @property
    def dof(self) -> Array:
        """Measured numbers less those spent on nuisances (time,)."""

    @property
    def of_rate(self) -> bool:
        """Whether it tells the rate and not the attitude."""

    @property
    def unknowns_fixed(self) -> int:
        """Leading unknowns that only name the frame: 3 where the points are unknown too."""

    def told(self, q: Array, rate: Array, epochs: Epochs = slice(None)) -> Told:
        """Return what the epochs say at attitudes (..., 4) and rates (..., 3)."""

    def normal(self, course: Course) -> Normal:
        """Return the normal equations at the motions (all epochs)."""

    def chi2(self, q: Array, rate: Array) -> Array:
        """Return the chi-squares (...) of all epochs of motions, nuisances at their best."""

    def within(self, epochs: BoolArray) -> Self:
        """Return the evidence of some epochs."""

    def settled(self, q: Array) -> Self:
        """Return it with its nuisances at their best for attitudes (time, 4)."""

    def seen(self) -> Seen:
        """Return attitudes of single epochs."""

    def squares(self, q: Array, rate: Array) -> Array:
        """Return the normalised square of each measurement (three numbers), NaN if not seen."""

    def gated(self, q: Array, rate: Array, limit: float) -> Self:
        """Return it without measurements whose normalised square exceeds ``limit``."""

    def scaled(self, noise: float) -> Self:
        """Return it with all standard deviations multiplied by ``noise``."""


def summed(told: Told, derivative: Array) -> Normal:
    """Return normal equations of independent epochs, with ``derivative (..., time, 3, p)``."""
    shape = (*derivative.shape[:-3], -1, derivative.shape[-1])
    back = np.swapaxes(derivative.reshape(shape), -1, -2)
    hold = back @ (told.hold @ derivative).reshape(shape)
    pull = (back @ told.pull.reshape(*shape[:-1], 1))[..., 0]
    return Normal(told.chi2.sum(axis=-1), pull, hold)


def vector_of(matrix: NDArray[Any]) -> Array:
    """``sum z x y``-like vector (..., 3) of ``A = sum z y^T``: that of ``A - A^T``, y cross z."""
    result = np.empty(matrix.shape[:-1])
    for k, (i, j) in enumerate(((2, 1), (0, 2), (1, 0))):
        result[..., k] = matrix[..., i, j] - matrix[..., j, i]
    return result
