"""Gauss-Newton on the state at epoch 0, over all measurements up to an epoch, with step control."""

from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.descent import Damping, descend
from debrisest.filters.linear_algebra import scaled_inverse, scaled_solve, solve
from debrisest.filters.replay.measured_arc import Linearization, MeasuredArc, linearize
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.runs import take

CONVERGED = 1e-2
"""The predicted decrease of the cost below which the iteration ends: a step of 0.1 sigma, in all
directions together, which is taken yet."""
_FIRST_DAMPING, _LEAST_DAMPING = 0.1, 0.01
_CHARTS = 2  # rounds in which an error comes to lie where it is kept, of a chart that bends
_LIMITS = 6
"""Rounds in which limits of a step are found, one of which may bring up or undo another."""


class Held(NamedTuple):
    """One plain error of each run beside a state, kept at a value while all else is free."""

    error: IntArray
    """Which one, (run,)."""
    beside: Array
    """State (run, n) at epoch 0."""
    value: Array
    sigma: Array
    """How firmly it is kept, (run,)."""

    def miss(self, model: ReplayModel, state: Array) -> Array:
        """Return by how much (run,) states at epoch 0 fall short of it."""
        runs = np.arange(len(state))
        return self.value - model.plain_difference(state, self.beside)[runs, self.error]

    def kept(self, model: ReplayModel, state: Array) -> Array:
        """Return states at epoch 0 with it where it is kept, if it alone can be moved to there."""
        step, moved = np.zeros((len(state), len(model.error_names))), state
        for _ in range(_CHARTS):
            step[np.arange(len(state)), self.error] = self.miss(model, moved)
            moved = move(model, moved, step)
        there = np.abs(self.miss(model, moved)) < self.sigma
        return np.where(there[:, None], moved, state)

    def added(self, model: ReplayModel, at: Linearization) -> Linearization:
        """Return a linearised cost with it, as one more measurement."""
        runs, miss, weight = np.arange(len(at.state)), self.miss(model, at.state), self.sigma**-2.0
        at.information[runs, self.error, self.error] += weight
        at.gradient[runs, self.error] += weight * miss
        return at._replace(cost=at.cost + weight * miss**2)


class Solution(NamedTuple):
    """Where Gauss-Newton stopped: the step is to be taken from ``at.state``, in plain errors."""

    at: Linearization
    step: Array
    decrement: Array
    """Decrease of the cost that the undamped step promises, (run,), within the model's limits."""

    @property
    def converged(self) -> BoolArray:
        """Which runs are (run,)."""
        return self.decrement < CONVERGED

    @property
    def cost(self) -> Array:
        """Cost after the step, to second order; where that promises much, the cost before it."""
        return np.where(self.converged, self.at.cost - self.decrement, self.at.cost)


def gauss_newton(
    model: ReplayModel,
    arc: MeasuredArc,
    state: Array,
    last: int,
    iterations: int,
    tolerance: float = CONVERGED,
    held: Held | None = None,
) -> Solution:
    """Minimise the cost of epochs 0 to ``last`` from ``state (run, n)`` at epoch 0.

    A step that raises the cost is taken back, and the next one is damped by a part of the prior's
    information (the information itself as a measure stalls in the long valleys of such costs).
    `iterations` counts linearisations; runs stop one by one, where the decrease that the next step
    promises is below `tolerance`. What is `held` adds to the cost by as much as it is missed.
    """

    arc = arc.until(last)

    def place(runs: IntArray, state: Array) -> Linearization:
        part = model.of(runs)
        if held is None:
            return linearize(part, take(arc, runs), state, last)
        own = take(held, runs)
        return own.added(part, linearize(part, take(arc, runs), own.kept(part, state), last))

    def step(at: Linearization, runs: IntArray, damping: Array) -> tuple[Array, Array]:
        return _step(model.of(runs), at, arc.information[runs], damping)

    def trial(best: Linearization, runs: IntArray, step: Array) -> Linearization:
        return place(runs, move(model.of(runs), best.state[runs], step))

    first = place(np.arange(len(state)), state)
    damping = Damping(0.0, _next_damping, lambda _, promise, __: promise < tolerance)
    return Solution(*descend(first, lambda at: at.cost, step, trial, damping, iterations))


def move(model: ReplayModel, state: Array, step: Array) -> Array:
    """State after a step in plain errors, taken in the state's own chart."""
    if model.frames is not None:
        return model.frames.move(state, step)
    return model.retract(state, (model.chart(state) @ step[..., None])[..., 0])


def _step(
    model: ReplayModel, at: Linearization, prior: Array, damping: Array
) -> tuple[Array, Array]:
    """Damped step, and the decrease of the cost that the undamped one promises."""
    step = _limited_step(model, at, prior, np.zeros(len(damping)))
    curved = (at.information @ step[..., None])[..., 0]
    decrement = (step * (2.0 * at.gradient - curved)).sum(-1)
    damped = np.flatnonzero(damping > 0.0)
    if len(damped):
        part = take(at, damped), prior[damped], damping[damped]
        step[damped] = _limited_step(model.of(damped), *part)
    return step, decrement


def _limited_step(model: ReplayModel, at: Linearization, prior: Array, damping: Array) -> Array:
    """Best step that `retract` will not cut, damped by a part (run,) of the prior's information."""
    step = _free_step(at, prior, damping)
    if model.excess is None:
        return step
    rows, excess = model.excess(at.state, step)
    runs = np.flatnonzero((excess != 0.0).any(-1))
    if len(runs):
        matrix = at.information[runs] + damping[runs, None, None] * prior[runs]
        toward = scaled_inverse(matrix) @ np.swapaxes(rows[runs], -1, -2)
        limits = rows[runs], excess[runs], toward
        step[runs] = _within(model.of(runs), at.state[runs], step[runs], *limits)
    return step


def _free_step(at: Linearization, prior: Array, damping: Array) -> Array:
    if not compiled.available():
        damps = damping[:, None, None] * prior if damping.any() else 0.0
        return scaled_solve(at.information + damps, at.gradient)
    from debrisest.filters.replay.step_loops import steps

    return steps(at.information, at.gradient, prior, damping)


def _within(
    model: ReplayModel, state: Array, free: Array, rows: Array, excess: Array, toward: Array
) -> Array:
    """Steps whose limited numbers are at their limits or within, and all else is the best with it.

    What would go on beyond is held, as ``toward (run, n_e, c)`` moves it, and what is held and
    would rather go back is let go: with a limit held, another may no longer be one.
    """
    assert model.excess is not None
    asked = (rows @ free[..., None])[..., 0]
    side, limit = np.sign(excess), asked + excess
    for _ in range(_LIMITS):
        held = side != 0.0
        both = held[..., None, :] & held[..., None]
        matrix = np.where(both, rows @ toward, np.eye(held.shape[-1]))
        force = solve(matrix, np.where(held, limit - asked, 0.0)[..., None])[..., 0]
        step = free + (toward @ force[..., None])[..., 0]
        beyond = np.where(held, 0.0, model.excess(state, step)[1])
        back = held & (force * side < 0.0)
        if not (back | (beyond != 0.0)).any():
            break
        limit = np.where(beyond != 0.0, (rows @ step[..., None])[..., 0] + beyond, limit)
        side = np.where(back, 0.0, np.where(held, side, np.sign(beyond)))
    return step


def _next_damping(damping: Array, better: BoolArray) -> Array:
    less = np.where(damping / 10.0 < _LEAST_DAMPING, 0.0, damping / 10.0)
    return np.where(better, less, np.maximum(_FIRST_DAMPING, 10.0 * damping))
