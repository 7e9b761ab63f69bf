"""Gauss-Newton that finds its weights, and so the outliers, as it goes along."""

import numpy as np

from debrisest.arrays import Array
from debrisest.filters import weights
from debrisest.filters.replay.gauss_newton import Solution, gauss_newton, move
from debrisest.filters.replay.measured_arc import Linearization, MeasuredArc, linearize
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
) -> Solution:
    """Minimise the cost of epochs 0 to ``last``, of which ``frames`` were measured, with outliers.

    Passes with Cauchy's weights, then one with hard rejection; in the first few frames, where a
    hard decision could be wrong for good, all passes are soft. Of several ``starts (run, n)`` each
    run keeps the one that ends with the least loss. The weights in `arc` are replaced.
    """
    best, weight, loss = _settle(model, arc, starts[0], last, frames, iterations)
    for start in starts[1:]:
        other, other_weight, other_loss = _settle(model, arc, start, last, frames, iterations)
        runs = np.flatnonzero(~(loss <= other_loss))
        put(best.at, runs, take(other.at, runs))
        best.step[runs], best.decrement[runs] = other.step[runs], other.decrement[runs]
        weight[runs], loss[runs] = other_weight[runs], other_loss[runs]
    arc.weight[:, : last + 1] = weight
    return best


def _settle(
    model: ReplayModel, arc: MeasuredArc, start: Array, last: int, frames: int, iterations: int
) -> tuple[Solution, Array, Array]:
    """Solution from one start, its weights and its loss."""
    seen = arc.seen[:, : last + 1]
    weighted = arc._replace(weight=arc.weight.copy())
    residual = linearize(model, weighted, start, last).residual
    passes = [weights.cauchy] * (_EARLY_PASSES if frames <= _EARLY_FRAMES else 1)
    passes.append(weights.cauchy if frames <= _SOFT_FRAMES else weights.hard)
    for rule in passes:
        weight = seen * rule(residual)
        weighted.weight[:, : last + 1] = weight
        solution = gauss_newton(model, weighted, start, last, iterations)
        start, residual = move(model, solution.at.state, solution.step), solution.at.residual
    return solution, weight, _loss(model, arc, solution.at)


def _loss(model: ReplayModel, arc: MeasuredArc, at: Linearization) -> Array:
    offset = model.plain_difference(arc.prior, at.state)
    prior = (offset[:, None] @ arc.information @ offset[..., None])[:, 0, 0]
    squares = (at.residual / weights.CAUCHY_SCALE) ** 2
    return np.asarray(prior + weights.cauchy_loss(squares).sum((-2, -1)))
