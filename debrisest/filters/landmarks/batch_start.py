"""Start of a landmark filter by a batch: growing windows, from both mirrors, with restarts."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.landmarks.cost import Prior, Unknowns
from debrisest.filters.landmarks.growing_windows import Fit, Window, fit, fresh
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.rivals import GIVEN_UP, squared_distance
from debrisest.filters.runs import put, take

_MOST_FALSE, _MOST_STRAY = 0.5, 0.02
"""Share of sightings that disagree beyond which a fit is none: with false matches, and without."""
_CONFIRMED_SHARE, _CONFIRMED_SIGHTINGS = 0.6, 5


class Batch(NamedTuple):
    """Settings of the batch."""

    windows: Sequence[Window]
    iterations: int = 15
    restarts: int = 4
    robust: bool = False
    mirrored: bool = True

    def agrees(self, fit: Fit) -> BoolArray:
        """Return whether most sightings agree with a fit, (run,)."""
        return np.asarray(fit.found.far < (_MOST_FALSE if self.robust else _MOST_STRAY))

    def accepts(self, fit: Fit) -> BoolArray:
        """Return whether most agrees with a fit, and does so as noise has it, (run,)."""
        sound = np.isfinite(fit.found.value) & self.agrees(fit)
        return np.asarray(sound & (fit.found.ratio < fit.found.limit))


class Rivals(NamedTuple):
    """The better one of two solutions, the other one, and how often a run was begun anew."""

    best: Fit
    other: Fit
    restarts: IntArray
    settled: BoolArray
    """Whether a restart has ended in the same place (run,): what does not fit is the model."""

    @property
    def gap(self) -> Array:
        """By how much the other's cost is higher (run,); infinite where it is the same fit."""
        gap = self.other.found.value - self.best.found.value
        apart = np.isfinite(gap) & ~_same(self.best, self.other)
        return np.where(apart, gap, np.inf)


class Problem(NamedTuple):
    """What a batch is about, of some runs."""

    model: LandmarkModel
    observed: Observations
    prior: Prior
    covariance: Array
    """Of the first guess, (run, n_x + 3 N, n_x + 3 N)."""
    batch: Batch

    @property
    def parameters(self) -> Array:
        """First guess of the start, (run, n_x)."""
        return self.prior.mean[:, : self.prior.mean.shape[-1] - 3 * self.model.landmarks]

    def of(self, runs: IntArray) -> "Problem":
        """Return the same of some of the runs."""
        part = self.model.of(runs), self.observed.at(runs), take(self.prior, runs)
        return Problem(*part, self.covariance[runs], self.batch)


def batch_problem(
    model: LandmarkModel, observed: Observations, parameters: Array, covariance: Array, batch: Batch
) -> Problem:
    """Return the problem of first guesses ``parameters (run, n_x)``.

    ``covariance (run, n_x + 3 N, n_x + 3 N)`` is their own and that of landmarks about the places
    where they are first put.
    """
    mean = np.concatenate([parameters, np.zeros((len(parameters), 3 * model.landmarks))], axis=-1)
    return Problem(model, observed, Prior(mean, scaled_inverse(covariance)), covariance, batch)


def batch_start(task: Problem) -> Rivals:
    """Estimate the start of every run from its first windows, twice where its mirror fits, too."""
    parameters, batch = task.parameters, task.batch
    runs = len(parameters)
    none = np.zeros(runs, dtype=np.int64), np.zeros(runs, dtype=np.bool_)
    found = Rivals(*_solve(task, parameters), *none)
    for attempt in range(batch.restarts):
        bad = np.flatnonzero(~batch.accepts(found.best) & ~found.settled)
        if len(bad) == 0:
            break
        part = task.of(bad)
        adopt(found, bad, *_solve(part, _redrawn(part, attempt)))
    return found


def adopt(found: Rivals, runs: IntArray, best: Fit, other: Fit) -> IntArray:
    """Put new solutions of some runs in the place of worse ones; return which, and count."""
    found.restarts[runs] += 1
    found.settled[runs] = _same(take(found.best, runs), best)
    won = np.flatnonzero(best.found.value < found.best.found.value[runs])
    put(found.best, runs[won], take(best, won))
    put(found.other, runs[won], take(other, won))
    return won


def _solve(task: Problem, parameters: Array) -> tuple[Fit, Fit]:
    """Better one of the solution and its mirror, and the other one."""
    model, batch = task.model, task.batch
    at, prior = fresh(model, parameters, task.prior)
    best = fit(model, task.observed, at, prior, batch.windows, batch.iterations, batch.robust)
    best, other = ordered(best, mirrored(task, best, batch.windows[2::2]))
    bad = np.flatnonzero(~batch.accepts(best))
    if len(bad) and batch.mirrored:
        part, wrong = task.of(bad), take(best, bad)
        for old, new in zip(
            (best, other), ordered(wrong, mirrored(part, wrong, batch.windows[1::2]))
        ):
            put(old, bad, new)
    return best, other


def ordered(best: Fit, other: Fit) -> tuple[Fit, Fit]:
    """Both fits, the one with the lower cost first."""
    swapped = np.flatnonzero(other.found.value < best.found.value)
    former = take(best, swapped)
    put(best, swapped, take(other, swapped))
    put(other, swapped, former)
    return best, other


def mirrored(task: Problem, best: Fit, windows: Sequence[Window]) -> Fit:
    """Fit that begins at the mirror; where it is hopeless, it ends early, with infinite cost."""
    batch = task.batch
    runs = np.arange(len(best.found.value))
    ratio = best.found.value / np.maximum(best.found.dof, 1)
    result = take(best, runs)
    result.found.value[:] = np.inf
    if not batch.mirrored:
        return result
    parameters, points = task.model.mirror(best.at.parameters, best.at.points)
    at = Unknowns(parameters, points, best.at.placed.copy())
    for window in dict.fromkeys([*windows, batch.windows[-1]]):
        part = task.of(runs)
        found = fit(
            *(part.model, part.observed, at, take(best.prior, runs)),
            *([window], batch.iterations, batch.robust),
        )
        excess = found.found.value - found.found.dof * ratio[runs]
        kept = np.flatnonzero(excess < GIVEN_UP)
        found, runs = take(found, kept), runs[kept]
        if len(runs) == 0:
            return result
        at = found.at
    put(result, runs, found)
    return result


def _same(one: Fit, other: Fit) -> BoolArray:
    """Whether two fits are the same minimum: their distance is small beside its sigma."""
    offset = one.at.vector - other.at.vector
    distance = squared_distance(offset, one.found.information)
    return np.asarray(distance < offset.shape[-1])


def leads_to(begun: Fit, best: Fit) -> BoolArray:
    """Whether fits of the first windows are where those of longer ones are, (run,).

    Led on, they would end in the same place.
    """
    points = np.where(begun.at.placed[..., None], begun.at.points, best.at.points)
    return _same(begun._replace(at=begun.at._replace(points=points)), best)


def redrawn(task: Problem, attempt: int) -> Fit:
    """Better solution of the first windows from another first guess."""
    return _solve(task, _redrawn(task, attempt))[0]


def _redrawn(task: Problem, attempt: int) -> Array:
    """First guess with other errors, of the size of its covariance.

    The draws are a fixed sequence, the same for every run: they belong to a deterministic
    algorithm and are no part of the experiment's randomness, so that a run's estimate depends on
    nothing but its measurements, neither on the seed nor on the runs beside it.
    """
    n_x = task.parameters.shape[-1]
    drawn = np.random.default_rng(attempt).normal(size=n_x)
    sigma = np.sqrt(np.diagonal(task.covariance, 0, -2, -1)[:, :n_x])
    return np.asarray(task.parameters + sigma * drawn)


def confirmed(best: Fit) -> BoolArray:
    """Landmarks of which most sightings agree with the fit."""
    seen, agreeing = best.found.sightings, best.found.agreeing
    enough = (agreeing > _CONFIRMED_SHARE * seen) & (seen >= _CONFIRMED_SIGHTINGS)
    return np.asarray(best.at.placed & enough)
