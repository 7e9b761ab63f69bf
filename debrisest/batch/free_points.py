"""Points of a body nobody knows as evidence: their places are unknowns, and eliminated exactly.

At given attitudes the places ``f`` solve a linear system whose matrix, the Laplacian of who was
seen with whom, is the same for the three axes and for all attitudes: it is factored once. What
stays are the unknowns of the arc, less the attitude at its epoch, which only names the body axes.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray
from debrisest.attitude import quaternion
from debrisest.batch.arc import UNKNOWNS, Course
from debrisest.batch.evidence import Epochs, Normal, Seen, Told
from debrisest.batch.point_sums import KnownPoints
from debrisest.batch.tracks import Tracks


@dataclass(frozen=True)
class FreePoints:
    """Evidence of points whose places in the body are unknown too."""

    tracks: Tracks
    model: Array
    """Places (feature, 3), m, as far as they are known; the mean of a connected set is zero."""
    of_rate = False
    unknowns_fixed = 3

    @cached_property
    def known(self) -> KnownPoints:
        """The same with the points where they are."""
        return KnownPoints(self.tracks, self.model)

    @property
    def times(self) -> Array:
        """Times (time,), s."""
        return self.tracks.times

    @cached_property
    def dof(self) -> Array:
        """Three for each point but one, less the share of the points' places (time,)."""
        seen = self.known.dof
        rank = np.linalg.matrix_rank(self.inverse_laplacian, hermitian=True)
        return np.asarray(seen * max(1.0 - 3.0 * rank / max(float(seen.sum()), 1.0), 0.0))

    @cached_property
    def inverse_laplacian(self) -> Array:
        """Covariance (feature, feature) of the places at known attitudes, the mean being zero."""
        weight = self.tracks.weight
        share = weight / np.maximum(weight.sum(axis=1, keepdims=True), np.finfo(float).tiny)
        laplacian = np.diag(weight.sum(axis=0)) - weight.T @ share
        return np.linalg.pinv(0.5 * (laplacian + laplacian.T), 1e-9, hermitian=True)

    def settled(self, q: Array) -> Self:
        """Return it with the points that fit attitudes (time, 4) best."""
        if compiled.available():
            from debrisest.batch import free_points_loops

            pull = free_points_loops.pulled(*self._seen, np.ascontiguousarray(q))
        else:
            back = self.tracks.centred() @ quaternion.to_matrix(q)
            pull = np.sum(self.tracks.weight[..., None] * back, axis=0)
        return type(self)(self.tracks, self.inverse_laplacian @ pull)

    @property
    def _seen(self) -> tuple[Array, Array]:
        """Points and weights as the loops take them."""
        return np.ascontiguousarray(self.tracks.points), np.ascontiguousarray(self.tracks.weight)

    def told(self, q: Array, rate: Array, epochs: Epochs = slice(None)) -> Told:
        """Return what the epochs say at attitudes (..., 4), the points being where they are."""
        if q.ndim > 2 or not isinstance(epochs, slice) or not compiled.available():
            return self.known.told(q, rate, epochs)
        from debrisest.batch import free_points_loops

        points, weight = (np.ascontiguousarray(part[epochs]) for part in self._seen)
        told = free_points_loops.told(points, weight, self.model, np.ascontiguousarray(q))
        return Told(*told)

    def normal(self, course: Course) -> Normal:
        """Return the normal equations of arcs, the points at their best, one after the other."""
        if compiled.available():
            return self._by_loops(course)
        if course.q.ndim > 2:
            each = [self.normal(Course(*parts)) for parts in zip(*course)]
            return Normal(*(np.stack(parts) for parts in zip(*each)))
        settled = self.settled(course.q)
        normal = settled.known.normal(course)
        cross = settled.cross(course)
        spent = np.tensordot(
            cross, np.tensordot(self.inverse_laplacian, cross, 1), ((0, 1), (0, 1))
        )
        return normal._replace(hold=normal.hold - spent)

    def _by_loops(self, course: Course) -> Normal:
        from debrisest.batch import free_points_loops

        shape = course.q.shape[:-2]
        q, by = np.ascontiguousarray(course.q), np.ascontiguousarray(course.turn_by)
        motion = q.reshape(-1, *q.shape[-2:]), by.reshape(-1, *by.shape[-3:])
        told = free_points_loops.normal(*self._seen, self.inverse_laplacian, *motion)
        return Normal(*(part.reshape(shape + part.shape[1:]) for part in told))

    def cross(self, course: Course) -> Array:
        """Information (feature, 3, 11) between places and unknowns of the arc."""
        turn = np.swapaxes(quaternion.to_matrix(course.q), -1, -2) @ course.turn_by
        weighted = self.tracks.weight[..., None] * self.known.body
        count, features = self.tracks.weight.shape
        product = weighted.reshape(count, -1).T @ turn.reshape(count, -1)
        t = product.reshape(features, 3, 3, UNKNOWNS)
        rows = [t[:, 2, 1] - t[:, 1, 2], t[:, 0, 2] - t[:, 2, 0], t[:, 1, 0] - t[:, 0, 1]]
        return np.stack(rows, axis=1)

    def covariance(self, course: Course, arc_covariance: Array) -> Array:
        """Covariance (feature, 3, 3) of the places, m^2, about the mean of all."""
        moved = np.tensordot(self.inverse_laplacian, self.cross(course), 1)
        own = np.diag(self.inverse_laplacian)[:, None, None] * np.eye(3)
        return np.asarray(own + moved @ arc_covariance @ np.swapaxes(moved, -1, -2))

    def chi2(self, q: Array, rate: Array) -> Array:
        """Return the chi-squares (...) of all epochs, the points at their best."""
        if q.ndim > 2:
            return np.stack([self.chi2(*parts) for parts in zip(q, rate)])
        settled = self.settled(q)
        if compiled.available():
            return np.asarray(settled.told(q, rate).chi2.sum())
        return settled.known.chi2(q, rate)

    def within(self, epochs: BoolArray) -> Self:
        """Return the evidence of some epochs."""
        return type(self)(self.tracks.within(epochs), self.model)

    def seen(self) -> Seen:
        """Return attitudes of single epochs, from the points where they are."""
        return self.known.seen()

    def squares(self, q: Array, rate: Array) -> Array:
        """Return squares of the residuals (time, feature), the points at their best."""
        settled = self.settled(q)
        if not compiled.available():
            return settled.known.squares(q, rate)
        from debrisest.batch import free_points_loops

        seen = *self._seen, settled.model, np.ascontiguousarray(q)
        square, own = free_points_loops.residual_squares(*seen)
        return np.where(self.tracks.seen, square / own, np.nan)

    def gated(self, q: Array, rate: Array, limit: float) -> Self:
        """Return it without points off by more than ``limit`` (three degrees of freedom)."""
        kept = self.settled(q).known.gated(q, rate, limit)
        return type(self)(kept.tracks, kept.model)

    def scaled(self, noise: float) -> Self:
        """Return it with all standard deviations multiplied by ``noise``."""
        return type(self)(self.tracks.scaled(noise), self.model)
