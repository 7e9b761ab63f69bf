"""Gauss-Newton on the state at epoch 0, over all measurements up to an epoch, with step control."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.descent import Damping, descend
from debrisest.filters.linear_algebra import scaled_solve
from debrisest.filters.replay.measured_arc import Linearization, MeasuredArc, linearize
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.runs import take

CONVERGED = 1e-2
"""The predicted decrease of the cost below which the iteration ends."""
_FIRST_DAMPING, _LEAST_DAMPING = 0.1, 0.01


class Solution(NamedTuple):
    """Where Gauss-Newton stopped: the step is to be taken from ``at.state``, in plain errors."""

    at: Linearization
    step: Array
    decrement: Array
    """Decrease of the cost that the undamped step promises, (run,)."""

    @property
    def converged(self) -> BoolArray:
        """Which runs are (run,)."""
        return self.decrement < CONVERGED

    @property
    def cost(self) -> Array:
        """Cost after the step, to second order."""
        return self.at.cost - self.decrement


def gauss_newton(
    model: ReplayModel, arc: MeasuredArc, state: Array, last: int, iterations: int
) -> Solution:
    """Minimise the cost of epochs 0 to ``last`` from ``state (run, n)`` at epoch 0.

    A step that raises the cost is taken back, and the next one is damped by a part of the prior's
    information (the information itself as a measure stalls in the long valleys of such costs).
    `iterations` counts linearisations; runs stop one by one.
    """

    def step(at: Linearization, runs: IntArray, damping: Array) -> tuple[Array, Array]:
        return _step(at, arc.information[runs], damping)

    def trial(best: Linearization, runs: IntArray, step: Array) -> Linearization:
        part = model.of(runs)
        return linearize(part, take(arc, runs), move(part, best.state[runs], step), last)

    first = linearize(model, arc, state, last)
    return Solution(*descend(first, lambda at: at.cost, step, trial, _DAMPING, iterations))


def move(model: ReplayModel, state: Array, step: Array) -> Array:
    """State after a step in plain errors, taken in the state's own chart."""
    return model.retract(state, (model.chart(state) @ step[..., None])[..., 0])


def _step(at: Linearization, prior: Array, damping: Array) -> tuple[Array, Array]:
    step = scaled_solve(at.information, at.gradient)
    decrement = (at.gradient * step).sum(-1)
    damped = np.flatnonzero(damping > 0.0)
    if len(damped):
        matrix = at.information[damped] + damping[damped, None, None] * prior[damped]
        step[damped] = scaled_solve(matrix, at.gradient[damped])
    return step, decrement


def _next_damping(damping: Array, better: BoolArray) -> Array:
    less = np.where(damping / 10.0 < _LEAST_DAMPING, 0.0, damping / 10.0)
    return np.where(better, less, np.maximum(_FIRST_DAMPING, 10.0 * damping))


_DAMPING = Damping(0.0, _next_damping, lambda _, promise, __: promise < CONVERGED)
