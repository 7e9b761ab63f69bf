"""Start of a landmark filter by a batch: growing windows, from both mirrors, with restarts."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.landmarks.cost import Prior, Unknowns
from debrisest.filters.landmarks.growing_windows import Fit, Window, fit, fresh
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.runs import put, take
from debrisest.outcome import Outcome

_PRUNE = 100.0
"""Excess of cost beyond the other solution's at which the mirror is given up early."""
_DECISIVE = 20.0
"""Difference of the costs of two solutions, twice the logarithm of their odds, that decides."""
_VAGUE = 0.03
"""Sigma of the points by their distance from the centre, above which the shape is not known."""
_CONFIRMED_SHARE, _CONFIRMED_SIGHTINGS = 0.6, 5
_FEWEST = 4


class StartStatus(Outcome):
    """How the batch of a run ended."""

    FOUND = 0, "finished"
    AMBIGUOUS = (
        1,
        "depth ambiguous: the motion and its depth-reversed mirror fit the images about as well; "
        "a longer batch, or a target that turns more, is needed to tell them apart",
    )
    REJECTED = (
        2,
        "start rejected: after all restarts the batch still fits its images worse than noise "
        "allows; a better first guess or fewer false matches are needed",
    )
    TOO_FEW = (
        3,
        f"too few landmarks: the batch confirms fewer than {_FEWEST}, which hardly tell the "
        "motion; a longer batch, longer tracks or fewer false matches are needed",
    )


class Batch(NamedTuple):
    """Settings of the batch."""

    windows: Sequence[Window]
    extended: Sequence[Window] = ()
    """For the runs whose mirrors the windows do not tell apart, or whose shape is still vague."""
    iterations: int = 15
    restarts: int = 4
    robust: bool = False
    mirrored: bool = True
    inflation: float = 1.5
    """Of the covariance that is handed on."""

    @property
    def limit(self) -> float:
        """Cost per degree of freedom of a good fit; Cauchy's counts outliers too."""
        return 5.0 if self.robust else 1.3


class Started(NamedTuple):
    """What the batch hands to the filter, at epoch 0."""

    core: Array
    points: Array
    covariance: Array
    """(run, n_c + 3 N, n_c + 3 N), zero for landmarks that are not there."""
    present: BoolArray
    """Landmarks that were seen often enough to be believed, (run, N)."""
    last: IntArray
    """Last epoch that the batch has used, (run,)."""
    status: IntArray
    restarts: IntArray
    ratio: Array
    """Cost per degree of freedom, (run,)."""


class _Problem(NamedTuple):
    model: LandmarkModel
    observed: Observations
    prior: Prior
    batch: Batch

    def of(self, runs: IntArray) -> "_Problem":
        part = self.model.of(runs), self.observed.at(runs), take(self.prior, runs)
        return _Problem(*part, self.batch)


def batch_start(
    model: LandmarkModel, observed: Observations, parameters: Array, covariance: Array, batch: Batch
) -> Started:
    """Estimate the start of every run from its first windows.

    ``parameters (run, n_x)`` are the first guess; ``covariance (run, n_x + 3 N, n_x + 3 N)`` is its
    own and that of landmarks about the places where they are first put.
    """
    runs = len(parameters)
    mean = np.concatenate([parameters, np.zeros((runs, 3 * model.landmarks))], axis=-1)
    task = _Problem(model, observed, Prior(mean, scaled_inverse(covariance)), batch)
    best, other = _solve(task, parameters)
    restarts = np.zeros(runs, dtype=np.int64)
    for attempt in range(batch.restarts):
        bad = np.flatnonzero(~(best.ratio < batch.limit))
        if len(bad) == 0:
            break
        part = task.of(bad)
        new, second = _solve(part, _redrawn(part, parameters[bad], covariance[bad], attempt))
        won = new.found.value < best.found.value[bad]
        put(best, bad[won], take(new, np.flatnonzero(won)))
        put(other, bad[won], take(second, np.flatnonzero(won)))
        restarts[bad] = attempt + 1
    last = np.full(runs, batch.windows[-1].last)
    gap = _gap(best, other)
    unclear = np.flatnonzero((gap < _DECISIVE) | _vague(best))
    if len(unclear) and batch.extended:
        _extend(task, best, other, unclear, gap)
        last[unclear] = batch.extended[-1].last
    return _handed_on(task, best, _gap(best, other), last, restarts)


def _solve(task: _Problem, parameters: Array) -> tuple[Fit, Fit]:
    """Better one of the solution and its mirror, and the other one."""
    model, batch = task.model, task.batch
    at, prior = fresh(model, parameters, task.prior)
    best = fit(model, task.observed, at, prior, batch.windows, batch.iterations, batch.robust)
    best, other = _ordered(best, _mirrored(task, best, batch.windows[2::2]))
    bad = np.flatnonzero(~(best.ratio < batch.limit))
    if len(bad) and batch.mirrored:
        part, wrong = task.of(bad), take(best, bad)
        for old, new in zip(
            (best, other), _ordered(wrong, _mirrored(part, wrong, batch.windows[1::2]))
        ):
            put(old, bad, new)
    return best, other


def _ordered(best: Fit, other: Fit) -> tuple[Fit, Fit]:
    """Both fits, the one with the lower cost first."""
    swapped = np.flatnonzero(other.found.value < best.found.value)
    former = take(best, swapped)
    put(best, swapped, take(other, swapped))
    put(other, swapped, former)
    return best, other


def _mirrored(task: _Problem, best: Fit, windows: Sequence[Window]) -> Fit:
    """Fit that begins at the mirror; where it is hopeless, it ends early, with infinite cost."""
    batch = task.batch
    runs = np.arange(len(best.ratio))
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
        excess = found.found.dof * (found.ratio - best.ratio[runs])
        kept = np.flatnonzero(excess < _PRUNE)
        found, runs = take(found, kept), runs[kept]
        if len(runs) == 0:
            return result
        at = found.at
    put(result, runs, found)
    return result


def _extend(task: _Problem, best: Fit, other: Fit, runs: IntArray, gap: Array) -> None:
    """Go on with longer windows, from both mirrors where both are still there.

    Where not, the other fit counts no longer: its cost is that of fewer frames.
    """
    batch, both = task.batch, np.isfinite(gap[runs])
    other.found.value[runs[~both]] = np.inf
    for old, chosen in ((best, runs), (other, runs[both])):
        if len(chosen):
            part, begin = task.of(chosen), take(old, chosen)
            found = fit(
                *(part.model, part.observed, begin.at, begin.prior),
                *(batch.extended, batch.iterations, batch.robust),
            )
            put(old, chosen, found)
    _ordered(best, other)


def _vague(best: Fit) -> BoolArray:
    """Whether the points are known too badly, beside their size, for a filter to go on from."""
    n_x = best.at.parameters.shape[-1]
    variance = np.diagonal(scaled_inverse(best.found.information), 0, -2, -1)[:, n_x:]
    there = np.repeat(_confirmed(best), 3, axis=-1)
    square = (best.at.points.reshape(variance.shape) ** 2 * there).sum(-1)
    return np.asarray((variance * there).sum(-1) > _VAGUE**2 * square)


def _gap(best: Fit, other: Fit) -> Array:
    """By how much the other fit's cost is higher (run,); infinite where it is the same fit."""
    gap = other.found.value - best.found.value
    return np.where(np.isfinite(gap) & ~_same(best, other), gap, np.inf)


def _same(one: Fit, other: Fit) -> BoolArray:
    """Whether two fits are the same minimum: their distance is small beside its sigma."""
    offset = one.at.vector - other.at.vector
    distance = (offset[:, None] @ one.found.information @ offset[..., None])[:, 0, 0]
    return np.asarray(distance < offset.shape[-1])


def _redrawn(task: _Problem, parameters: Array, covariance: Array, attempt: int) -> Array:
    """First guess with other errors, of the size of its covariance.

    The draws are a fixed sequence, the same for every run: they belong to a deterministic
    algorithm and are no part of the experiment's randomness, so that a run's estimate depends on
    nothing but its measurements, neither on the seed nor on the runs beside it.
    """
    n_x = parameters.shape[-1]
    drawn = np.random.default_rng(attempt).normal(size=n_x)
    sigma = np.sqrt(np.diagonal(covariance, 0, -2, -1)[:, :n_x])
    return np.asarray(parameters + sigma * drawn)


def _handed_on(
    task: _Problem, best: Fit, gap: Array, last: IntArray, restarts: IntArray
) -> Started:
    batch = task.batch
    core, by_parameters = task.model.start(best.at.parameters)
    covariance = batch.inflation * scaled_inverse(best.found.information)
    status = np.where(gap < _DECISIVE, StartStatus.AMBIGUOUS, StartStatus.FOUND)
    present = _confirmed(best)
    status = np.where(present.sum(-1) < _FEWEST, StartStatus.TOO_FEW, status)
    status = np.where(best.ratio < batch.limit, status, StartStatus.REJECTED)
    n_c, n_x = by_parameters.shape[-2:]
    whole = np.zeros((len(core), n_c + covariance.shape[-1] - n_x, covariance.shape[-1]))
    whole[:, :n_c, :n_x] = by_parameters
    whole[:, n_c:, n_x:] = np.repeat(present, 3, axis=-1)[..., None] * np.eye(3 * present.shape[-1])
    spread = whole @ covariance @ np.swapaxes(whole, -1, -2)
    return Started(
        *(core, best.at.points, spread, present, last, status, restarts, best.ratio),
    )


def _confirmed(best: Fit) -> BoolArray:
    """Landmarks of which most sightings agree with the fit."""
    seen, agreeing = best.found.sightings, best.found.agreeing
    enough = (agreeing > _CONFIRMED_SHARE * seen) & (seen >= _CONFIRMED_SIGHTINGS)
    return np.asarray(best.at.placed & enough)
