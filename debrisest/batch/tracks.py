"""Tracked points with a weight for each observation; the translation of every epoch is unknown."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray


class Tracks(NamedTuple):
    """Points in inertial axes from any origin; what is not seen has no weight."""

    times: Array
    """(time,), s."""
    points: Array
    """(time, feature, 3), m, zero where not seen."""
    weight: Array
    """One over the variance (time, feature), 1/m^2, zero where not seen."""
    even: Array
    """Mean square of the noise over the axes in units of that variance (time, feature): 1 if it is
    the same along all, less if the variance is that of the worst."""

    @property
    def seen(self) -> BoolArray:
        """Which observations count (time, feature)."""
        return np.asarray(self.weight > 0.0)

    def mean(self, vectors: Array) -> Array:
        """Weighted mean (time, 1, 3) of vectors (..., feature, 3) over the seen points."""
        total = np.maximum(self.weight.sum(axis=1), np.finfo(float).tiny)[:, None]
        summed = self.weight[:, None, :] @ vectors
        return np.asarray(summed / total[..., None])

    def centred(self) -> Array:
        """Points less the mean of their epoch (time, feature, 3)."""
        return np.asarray(self.points - self.mean(self.points))

    def within(self, epochs: BoolArray | slice) -> "Tracks":
        """Return some epochs."""
        return Tracks(*(part[epochs] for part in self))

    def without(self, observations: BoolArray) -> "Tracks":
        """Return the tracks less some observations (time, feature)."""
        return self._replace(weight=np.where(observations, 0.0, self.weight))

    def scaled(self, noise: float) -> "Tracks":
        """Return the tracks with their standard deviations multiplied by ``noise``."""
        return self._replace(weight=self.weight / noise**2)


def tracks(times: Array, points: Array, sigma: Array | float) -> Tracks:
    """Return tracks of ``points (time, feature, 3)``, NaN where not seen.

    ``sigma``, m, is a number or broadcasts to (time, feature) or (time, feature, 3); of three
    components the largest counts, so that no direction is trusted more than it is measured.
    """
    seen = np.asarray(np.isfinite(points).all(axis=-1))
    sigma = np.asarray(sigma, dtype=np.float64)
    even = np.ones(seen.shape)
    if sigma.ndim == 3:
        mean, sigma = np.mean(sigma**2, axis=-1), np.max(sigma, axis=-1)
        even = np.where(sigma > 0.0, mean / np.where(sigma > 0.0, sigma, 1.0) ** 2, 1.0)
    weight = np.where(seen & (sigma > 0.0), 1.0 / np.where(sigma > 0.0, sigma, 1.0) ** 2, 0.0)
    return Tracks(times, np.where(seen[..., None], points, 0.0), weight, even)
