"""Cost of a landmark model over the frames of a window, as a quadratic form at the start.

The unknowns are the start's parameters and the points. The cost is twice the negative logarithm of
the posterior density, or with Cauchy's loss one that lets go of false matches gradually.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.landmark_model import LandmarkModel, Observations, in_line
from debrisest.filters.landmarks.frame_sums import Sums, sums

_BLOCK = 32  # frames whose rows are held at a time


class Unknowns(NamedTuple):
    """Parameters (run, n_x) of the start, points (run, N, 3), and which of these exist."""

    parameters: Array
    points: Array
    placed: BoolArray
    """(run, N)."""

    @property
    def vector(self) -> Array:
        """All of them, (run, n_x + 3 N)."""
        return np.concatenate([self.parameters, in_line(self.points)], -1)

    def moved(self, step: Array) -> "Unknowns":
        """Return the unknowns after a step (run, n_x + 3 N)."""
        n_x = self.parameters.shape[-1]
        shift = step[:, n_x:].reshape(self.points.shape)
        return self._replace(parameters=self.parameters + step[:, :n_x], points=self.points + shift)


class Prior(NamedTuple):
    """Gaussian prior of the unknowns: mean (run, n_x + 3 N) and information (run, ., .)."""

    mean: Array
    information: Array

    def at(self, unknowns: Unknowns) -> tuple[Array, Array]:
        """Return what it costs (run,) to be there, and the gradient (run, n_x + 3 N)."""
        offset = self.mean - unknowns.vector
        gradient = (self.information @ offset[..., None])[..., 0]
        return (offset * gradient).sum(-1), gradient


class Cost(NamedTuple):
    """Cost (run,) around the unknowns, its information (run, n, n) and gradient (run, n)."""

    value: Array
    information: Array
    gradient: Array
    sightings: IntArray
    """Frames that show a landmark, (run, N)."""
    agreeing: IntArray
    """Those that do not look like false matches."""
    dof: IntArray
    """Components that count, (run,)."""
    squares: Array
    """Sum of the squares of those that do not look like false matches, (run,)."""
    squares_dof: IntArray
    """Their number, (run,)."""
    last: Array
    """Core (run, n) at the last frame."""
    by_start: Array
    """Derivative (run, n_c, n_x) of its errors by the parameters of the start."""

    @property
    def ratio(self) -> Array:
        """Square per component (run,), about one for the right minimum."""
        return np.asarray(self.squares / np.maximum(self.squares_dof, 1))

    @property
    def limit(self) -> Array:
        """Ratio (run,) that noise exceeds by chance once in a million times."""
        return np.asarray(1.0 + 5.0 * np.sqrt(2.0 / np.maximum(self.squares_dof, 1)))

    @property
    def far(self) -> Array:
        """Share of the sightings (run,) that look like false matches."""
        return np.asarray(1.0 - self.agreeing.sum(-1) / np.maximum(self.sightings.sum(-1), 1))


def cost(
    model: LandmarkModel,
    observed: Observations,
    prior: Prior,
    at: Unknowns,
    frames: IntArray,
    robust: bool,
) -> Cost:
    """Linearise the cost of the ``frames``, ascending epochs, at unknowns of all the runs."""
    course = model.course(at.parameters, frames)
    value, gradient = prior.at(at)
    total = Sums(value, prior.information, gradient, 0, 0, 0, 0.0, 0)
    for first in range(0, len(frames), _BLOCK):
        part = slice(first, first + _BLOCK)
        rows = model.rows(course.cores[:, part], at.points[:, None], frames[part])
        seen = observed.at(slice(None), frames[part])
        found = sums(model, rows, seen, at.placed, course.by_start(part), robust)
        total = Sums(*(old + new for old, new in zip(total, found)))
    return Cost(*total, course.cores[:, -1], course.last)
