"""Points of a known body as evidence: three sums of each epoch, and no loop over points again.

With points ``z`` and body points ``f``, both less their weighted mean over the seen ones of an
epoch, ``B = sum w z f^T`` and ``F = sum w f f^T``, the chi-square of an attitude ``R`` is
``sum w (|z|^2 + |f|^2) - 2 tr(R^T B)``; an epoch with two points tells two directions.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import Course
from debrisest.batch.evidence import Epochs, Normal, Seen, Told, summed, vector_of
from debrisest.batch.tracks import Tracks

_LEAST_SHARE = 0.3  # of a residual that is the point's own and not the mean's
_FEWEST_KEPT = 0.5  # a gate that leaves less has the wrong motion
_TELLS_A_TURN = 4.0  # information, 1/rad^2, of an attitude that is better than half a radian


@dataclass(frozen=True)
class KnownPoints:
    """Evidence of points whose places ``model (feature, 3)``, m, in the body are known."""

    tracks: Tracks
    model: Array
    of_rate = False
    unknowns_fixed = 0

    @property
    def times(self) -> Array:
        """Times (time,), s."""
        return self.tracks.times

    @cached_property
    def dof(self) -> Array:
        """Three for each point but one (time,), less where noise differs along the axes."""
        count = np.maximum(self.tracks.seen.sum(axis=1), 1.0)
        even = np.sum(self.tracks.even, axis=1, where=self.tracks.seen)
        return np.asarray(3.0 * (even - even / count))

    @cached_property
    def body(self) -> Array:
        """Body points less the mean of those seen at an epoch (time, feature, 3)."""
        return np.asarray(self.model - self.tracks.mean(self.model))

    @cached_property
    def sums(self) -> tuple[Array, Array, Array]:
        """``B``, ``tr(F) I - F`` (time, 3, 3) and the sum of squares (time,)."""
        measured, weight = self.tracks.centred(), self.tracks.weight[..., None]
        weighted = weight * self.body
        spread = np.swapaxes(self.body, -1, -2) @ weighted
        squares = np.sum(weight * (measured**2 + self.body**2), axis=(-2, -1))
        trace = np.trace(spread, axis1=-2, axis2=-1)[..., None, None]
        return np.swapaxes(measured, -1, -2) @ weighted, trace * np.eye(3) - spread, squares

    @property
    def for_loops(self) -> tuple[tuple[Array, Array, Array], Array]:
        """What `known_points_loops` take: points, places and evenness of noise, and weights."""
        tracked = self.tracks
        points = tracked.points, np.ascontiguousarray(self.model), tracked.even
        return points, np.ascontiguousarray(tracked.weight)

    @cached_property
    def loop_sums(self) -> tuple[Array, Array, Array, Array]:
        """The sums as loops take them (`known_points_loops.Sums`), and by them."""
        from debrisest.batch import known_points_loops

        return known_points_loops.sums(*self.for_loops)

    def told(self, q: Array, rate: Array, epochs: Epochs = slice(None)) -> Told:
        """Return what the epochs say at attitudes (..., 4); rates do not matter."""
        product, hold, squares = (part[epochs] for part in self.sums)
        attitude = quaternion.to_matrix(q)
        back = np.swapaxes(attitude, -1, -2)
        turned = product @ back
        chi2 = squares - 2.0 * np.trace(turned, axis1=-2, axis2=-1)
        return Told(chi2, vector_of(turned), attitude @ hold @ back)

    def normal(self, course: Course) -> Normal:
        """Return the normal equations at the motions."""
        if not compiled.available():
            return summed(self.told(course.q, course.rate), course.turn_by)
        from debrisest.batch import point_loops

        product, hold, squares = self.sums
        shape = course.q.shape[:-2]
        by = np.ascontiguousarray(course.turn_by).reshape(-1, *course.turn_by.shape[-3:])
        q = np.ascontiguousarray(course.q).reshape(*by.shape[:2], 4)
        fit, pull, held = point_loops.normal(q, by, product, hold)
        chi2 = squares.sum() - 2.0 * fit.reshape(shape)
        return Normal(chi2, pull.reshape(*shape, -1), held.reshape(*shape, *held.shape[1:]))

    def chi2(self, q: Array, rate: Array) -> Array:
        """Return the chi-squares (...) of all epochs."""
        product, _, squares = self.sums
        fit = np.sum(product * quaternion.to_matrix(q), axis=(-3, -2, -1))
        return np.asarray(squares.sum() - 2.0 * fit)

    def within(self, epochs: BoolArray) -> Self:
        """Return the evidence of some epochs."""
        return type(self)(self.tracks.within(epochs), self.model)

    def settled(self, q: Array) -> Self:
        """Return itself: it has no nuisances."""
        return self

    def seen(self) -> Seen:
        """Return the least-squares attitudes (Wahba) of epochs that tell all three directions."""
        return self._seen

    @cached_property
    def _seen(self) -> Seen:
        product, hold, _ = self.sums
        q = quaternion.nearest(product)
        attitude = quaternion.to_matrix(q)
        information = attitude @ hold @ np.swapaxes(attitude, -1, -2)
        tells = np.linalg.eigvalsh(hold)[:, 0] > _TELLS_A_TURN
        return Seen(np.where(tells[:, None], q, np.nan), information)

    def residuals(self, q: Array) -> Array:
        """Return measured less expected points (time, feature, 3), m, centred, NaN unseen."""
        expected = self.body @ np.swapaxes(quaternion.to_matrix(q), -1, -2)
        return np.where(self.tracks.seen[..., None], self.tracks.centred() - expected, np.nan)

    def gated(self, q: Array, rate: Array, limit: float) -> Self:
        """Return it without points off by more than ``limit`` (three degrees of freedom).

        The worst point of an epoch goes first, and the mean is taken anew; at most four of an
        epoch. Unchanged if more than half of all observations would go.
        """
        if compiled.available():
            return self._gated_compiled(q, limit)
        kept: Self = self
        for _ in range(4):
            worst = kept._worst(q, rate, limit)
            if not worst.any():
                break
            kept = type(self)(kept.tracks.without(worst), self.model)
        few = kept.tracks.seen.sum() < _FEWEST_KEPT * self.tracks.seen.sum()
        return self if few else kept

    def _gated_compiled(self, q: Array, limit: float) -> Self:
        from debrisest.batch import known_points_loops as loops

        (points, weight), at = self.for_loops, np.ascontiguousarray(q.T)
        square = np.empty(weight.shape)
        loops.squares(points, weight, at, square)
        return self.weighed(loops.gated(points, weight, at, square, limit))

    def weighed(self, weight: Array) -> Self:
        """Return it with other weights (time, feature)."""
        return type(self)(self.tracks._replace(weight=weight), self.model)

    def squares(self, q: Array, rate: Array) -> Array:
        """Return squares of the residuals (time, feature) over what the noise lets expect."""
        weight = self.tracks.weight
        share = weight / np.maximum(weight.sum(axis=1, keepdims=True), np.finfo(float).tiny)
        own = np.maximum(1.0 - share, _LEAST_SHARE)
        return np.asarray(np.sum(self.residuals(q) ** 2, axis=-1) * weight / own)

    def _worst(self, q: Array, rate: Array, limit: float) -> BoolArray:
        square = np.nan_to_num(self.squares(q, rate))
        return np.asarray((square > limit) & (square == square.max(axis=1, keepdims=True)))

    def scaled(self, noise: float) -> Self:
        """Return it with all standard deviations multiplied by ``noise``."""
        return type(self)(self.tracks.scaled(noise), self.model)
