"""Gauss-Newton that finds its weights, and so the outliers, as it goes along."""

from typing import Any

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters import weights
from debrisest.filters.replay.gauss_newton import CONVERGED, Solution, gauss_newton, move
from debrisest.filters.replay.measured_arc import MeasuredArc, residuals
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.runs import put, take

_EARLY_FRAMES, _SOFT_FRAMES = 10, 3
_EARLY_PASSES = 3


def robust_newton(
    model: ReplayModel,
    arc: MeasuredArc,
    starts: list[Array],
    last: int,
    frames: int,
    iterations: int,
    tolerance: float = CONVERGED,
) -> Solution:
    """Minimise the cost of epochs 0 to ``last``, of which ``frames`` were measured, with outliers.

    Where the weights so far find themselves confirmed by the residuals of their own solution, that
    is it. Else passes with Cauchy's weights, then one with hard rejection; in the first few frames,
    where a hard decision could be wrong for good, all passes are soft. Of several
    ``starts (run, n)`` each run keeps the one that ends with the least loss. The weights in `arc`
    are replaced.
    """
    limits = last, iterations, tolerance
    if frames <= _EARLY_FRAMES or len(starts) > 1:
        best, weight = _best_settled(model, arc, starts, frames, *limits)
        arc.weight[:, : last + 1] = weight
        return best
    best, runs = _confirmed(model, arc, starts[0], *limits)
    if len(runs):
        part, open_ = take(arc, runs), [starts[0][runs]]
        other, weight = _best_settled(model.of(runs), part, open_, frames, *limits)
        put(best, runs, other)
        arc.weight[runs, : last + 1] = weight
    return best


def _confirmed(
    model: ReplayModel,
    arc: MeasuredArc,
    start: Array,
    last: int,
    iterations: int,
    tolerance: float,
) -> tuple[Solution, IntArray]:
    """Solution with the weights as they are, and the runs whose residuals speak against these."""
    solution = gauss_newton(model, arc, start, last, iterations, tolerance)
    frames = slice(last + 1)
    found = arc.seen[:, frames] * weights.hard(_left(model, arc, solution.at.state, last))
    return solution, np.flatnonzero((found != arc.weight[:, frames]).any((-2, -1)))


def _best_settled(
    model: ReplayModel, arc: MeasuredArc, starts: list[Array], frames: int, *limits: Any
) -> tuple[Solution, Array]:
    """Solution of the start that ends with the least loss, and its weights."""
    best, weight, loss = _settle(model, arc, starts[0], frames, *limits)
    for start in starts[1:]:
        other, other_weight, other_loss = _settle(model, arc, start, frames, *limits)
        runs = np.flatnonzero(~(loss <= other_loss))
        put(best, runs, take(other, runs))
        weight[runs], loss[runs] = other_weight[runs], other_loss[runs]
    return best, weight


def _settle(
    model: ReplayModel,
    arc: MeasuredArc,
    start: Array,
    frames: int,
    last: int,
    iterations: int,
    tolerance: float,
) -> tuple[Solution, Array, Array]:
    """Solution from one start, its weights and its loss."""
    seen = arc.seen[:, : last + 1]
    weighted = arc._replace(weight=arc.weight.copy())
    residual = _left(model, arc, start, last)
    passes = [weights.cauchy] * (_EARLY_PASSES if frames <= _EARLY_FRAMES else 1)
    passes.append(weights.cauchy if frames <= _SOFT_FRAMES else weights.hard)
    for rule in passes:
        weight = seen * rule(residual)
        weighted.weight[:, : last + 1] = weight
        solution = gauss_newton(model, weighted, start, last, iterations, tolerance)
        start = move(model, solution.at.state, solution.step)
        residual = _left(model, arc, solution.at.state, last)
    return solution, weight, _loss(model, arc, solution.at.state, residual)


def loss(model: ReplayModel, arc: MeasuredArc, state: Array, last: int) -> Array:
    """Return the prior's cost and Cauchy's of all that was seen, (run,), whatever its weight."""
    return _loss(model, arc, state, _left(model, arc, state, last))


def _left(model: ReplayModel, arc: MeasuredArc, state: Array, last: int) -> Array:
    """Residuals of the motion from ``state (run, n)`` at epoch 0."""
    return residuals(model, arc, model.shown(state, last)[1])


def _loss(model: ReplayModel, arc: MeasuredArc, state: Array, residual: Array) -> Array:
    offset = model.plain_difference(arc.prior, state)
    prior = (offset[:, None] @ arc.information @ offset[..., None])[:, 0, 0]
    squares = (residual / weights.CAUCHY_SCALE) ** 2
    return np.asarray(prior + weights.cauchy_loss(squares).sum((-2, -1)))
