"""The time grid that all stages share."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array


class Clock(NamedTuple):
    """Equidistant epochs: ``duration`` and ``step`` in seconds, the first epoch at zero."""

    duration: float
    step: float

    @property
    def times(self) -> Array:
        """Return the epochs (time,) in seconds; the end itself is not one of them."""
        return np.arange(round(self.duration / self.step), dtype=np.float64) * self.step
