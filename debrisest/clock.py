"""The epochs that all stages share."""

from dataclasses import dataclass

import numpy as np

from debrisest.arrays import Array

_EVEN = 1e-6
"""Part of a step by which an epoch may be off for the epochs to count as equidistant."""


@dataclass(frozen=True, eq=False)
class Clock:
    """Ascending times (time,) in seconds, two or more; measured ones need not be equidistant."""

    times: Array

    @classmethod
    def regular(cls, duration: float, step: float) -> "Clock":
        """Return equidistant epochs from zero on; the end itself is not one of them."""
        return cls(np.arange(round(duration / step), dtype=np.float64) * step)

    @property
    def jitter(self) -> float:
        """Return how far an epoch is from an even grid at most, as a part of the grid's step."""
        if len(self.times) < 3:
            return 0.0
        even = np.linspace(self.times[0], self.times[-1], len(self.times))
        return float(np.abs(self.times - even).max() / (even[1] - even[0]))

    @property
    def step(self) -> float:
        """Return the time between epochs; ValueError, in a sentence, where it is not the same."""
        if self.jitter > _EVEN:
            raise ValueError(
                f"equal steps are needed, but the epochs are up to {self.jitter:.2g} steps away "
                f"from an even grid (allowed: {_EVEN:g}); resample the data to equal steps, or "
                "choose a problem that takes each epoch's own time"
            )
        return float(self.times[1] - self.times[0])

    @property
    def steps(self) -> Array:
        """Return the time from each epoch to the next (time - 1,)."""
        steps = np.diff(self.times)
        return steps if self.jitter > _EVEN else np.broadcast_to(steps[:1], steps.shape)

    def nearest(self, time: float) -> int:
        """Return the epoch nearest to a time."""
        return int(np.abs(self.times - time).argmin())

    def reaches(self, time: float) -> bool:
        """Return whether the last epoch is after a time, or no farther than half a step before."""
        return bool(time <= self.times[-1] + (self.times[-1] - self.times[-2]) / 2)
