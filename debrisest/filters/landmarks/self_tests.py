"""What the solution over a whole arc says of itself."""

from collections.abc import Iterator

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.landmarks.batch_start import Problem, confirmed
from debrisest.filters.landmarks.cost import Prior, Unknowns, cost
from debrisest.filters.landmarks.growing_windows import Fit
from debrisest.filters.landmarks.residuals import residuals, value
from debrisest.filters.landmarks.whole_arc import Arc
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.runs import take
from debrisest.filters.self_test import (
    bend_test,
    block_test,
    cost_test,
    lost_test,
    parts_test,
    rival_test,
    score_test,
)
from debrisest.filters.verdict import SelfTest

_FEWEST = 4
_NO_FIT = 4.0
"""Cost per degree of freedom of a solution that is none: residuals twice as large as the noise."""
_BLOCKS = 20
_WIDE = 0.03
"""Sigma by that of the prior, above which a direction is wide enough for the cost to bend."""
_SHOWN = 1e-6
"""Part of a doubt's information that must not be that of other unknowns."""


def self_tests(task: Problem, arc: Arc) -> list[SelfTest]:
    """Return the tests of all runs."""
    best = arc.found.best
    return [
        *_of_the_fit(task, arc),
        rival_test(arc.found.gap),
        cost_test(best.found.squares, best.found.squares_dof),
        *_halves(task, arc),
        *_blocks(task.model, arc.observed, best, arc.anchors[-1].epoch),
        *_doubts(task, arc),
        _bend(task, arc),
    ]


def _of_the_fit(task: Problem, arc: Arc) -> Iterator[SelfTest]:
    """Whether there is a solution at all."""
    best = arc.found.best
    yield lost_test(
        confirmed(best).sum(-1) < _FEWEST,
        f"fewer than {_FEWEST} landmarks are confirmed, which hardly tell the motion; longer "
        "tracks or fewer false matches are needed",
    )
    before, left = (seen.common_seen.sum((1, 2)) for seen in (task.observed, arc.observed))
    yield lost_test(
        left < 0.5 * before,
        "most ranges disagree with the images: are they those to the centre of mass, and is their "
        "noise what it is said to be?",
    )
    yield lost_test(
        ~(np.isfinite(best.found.value) & (best.found.ratio < _NO_FIT) & task.batch.agrees(best)),
        "after all restarts the best motion fits its images much worse than noise allows; a better "
        "first guess, fewer false matches or another model are needed",
    )


def _halves(task: Problem, arc: Arc) -> Iterator[SelfTest]:
    """The start as the first half of the arc has it, against that of the whole."""
    ends = np.array([anchor.epoch for anchor in arc.anchors])
    if len(ends) < 2:
        return
    half, whole = arc.fits[int(np.argmin(np.abs(ends[:-1] - 0.5 * ends[-1])))], arc.fits[-1]
    n_x = task.parameters.shape[-1]
    spreads = [scaled_inverse(fit.found.information)[:, :n_x, :n_x] for fit in (half, whole)]
    yield parts_test(half.at.parameters, whole.at.parameters, *spreads)


def _blocks(
    model: LandmarkModel, observed: Observations, best: Fit, last: int
) -> Iterator[SelfTest]:
    """Mean residuals of each landmark, and of all of them, in blocks of time."""
    owner = np.arange(last + 1) * _BLOCKS // (last + 1)
    runs, landmarks = best.at.placed.shape
    of_each = np.zeros((2, runs, _BLOCKS, landmarks, model.rows_each))
    of_all = np.zeros((2, runs, _BLOCKS, model.rows_each + model.common))
    for part, residual, common, shared in residuals(model, observed, best.at, last):
        seen = np.isfinite(residual)
        filled = np.where(seen, residual, 0.0)
        cause = np.where(seen[..., None], shared, 0.0)
        variance = seen + (cause**2).sum(-1)
        together = seen.sum(2) + (cause.sum(2) ** 2).sum(-1)
        for block in range(owner[part[0]], owner[part[-1]] + 1):
            of_it = owner[part] == block
            of_each[:, :, block] += [filled[:, of_it].sum(1), variance[:, of_it].sum(1)]
            image = [filled[:, of_it].sum((1, 2)), together[:, of_it].sum(1)]
            rest = [np.nansum(common[:, of_it], axis=1), np.isfinite(common[:, of_it]).sum(1)]
            of_all[:, :, block] += np.concatenate([image, rest], axis=-1)
    fitted = best.at.vector.shape[-1]
    yield block_test(_normalised(of_each), float(fitted))
    yield block_test(_normalised(of_all), 0.0)


def _normalised(sums: Array) -> Array:
    return np.where(sums[1] > 0.0, sums[0] / np.sqrt(np.maximum(sums[1], 1.0)), np.nan)


def _doubts(task: Problem, arc: Arc) -> Iterator[SelfTest]:
    """Whether the residuals pull away what the model holds fixed (Rao's score test)."""
    model, best = task.model, arc.found.best
    if model.doubted is None:
        return
    n_x, count = best.at.parameters.shape[-1], len(model.doubts)
    place = np.r_[0:n_x, n_x + count : best.at.vector.shape[-1] + count]
    doubt = np.arange(n_x, n_x + count)
    zeros = np.zeros((len(best.at.parameters), count))
    at = Unknowns(np.concatenate([best.at.parameters, zeros], -1), best.at.points, best.at.placed)
    mean = np.insert(best.prior.mean, [n_x] * count, 0.0, axis=-1)
    known = np.zeros((*mean.shape, mean.shape[-1]))
    known[:, place[:, None], place] = best.prior.information
    frames = np.arange(arc.anchors[-1].epoch + 1)
    found = cost(model.doubted(), arc.observed, Prior(mean, known), at, frames, False)
    own = found.information[:, doubt, doubt]
    cross = found.information[:, doubt[:, None], place]
    spread = scaled_inverse(found.information[:, place[:, None], place])
    pulled = (cross @ spread @ found.gradient[:, place, None])[..., 0]
    left = own - ((cross @ spread) * cross).sum(-1)
    left = np.where(left > _SHOWN * own, left, np.nan)
    size = (found.gradient[:, doubt] - pulled) / left
    for i, said in enumerate(model.doubts):
        yield score_test(size[:, i], left[:, i] ** -0.5, said.reason, said.scale)


def _bend(task: Problem, arc: Arc) -> SelfTest:
    """How the cost rises along the direction of the parameters that the data tell least of."""
    best, n_x = arc.found.best, task.parameters.shape[-1]
    spread = scaled_inverse(best.found.information)
    sigma = np.diagonal(task.covariance, 0, -2, -1)[:, :n_x] ** 0.5
    relative = spread[:, :n_x, :n_x] / (sigma[:, :, None] * sigma[:, None, :])
    sound: BoolArray = np.asarray(np.isfinite(relative).all((-2, -1)))
    values, vectors = np.linalg.eigh(np.where(sound[:, None, None], relative, np.eye(n_x)))
    rise = np.full(len(sound), np.nan)
    wide = np.flatnonzero(sound & (values[:, -1] > _WIDE**2))
    if len(wide) == 0:
        return bend_test(rise)
    along = vectors[wide, :, -1] / sigma[wide]
    step = (spread[wide, :, :n_x] @ along[..., None])[..., 0] / np.sqrt(values[wide, -1:])
    part, last = task.of(wide), arc.anchors[-1].epoch
    at, prior = take(best.at, wide), take(best.prior, wide)
    costs = [
        value(part.model, arc.observed.at(wide), prior, at.moved(x * step), last)
        for x in (0.0, -1.0, 1.0)
    ]
    rise[wide] = np.maximum(*costs[1:]) - costs[0]
    return bend_test(rise)
