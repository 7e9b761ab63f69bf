"""Gauss-Newton on the state at epoch 0, over all measurements up to an epoch, with step control.

The cost is twice the negative logarithm of the posterior density: the prior's and the residuals'
normalised squares. Its minimum is the maximum a posteriori estimate of the whole motion.
"""

from typing import Any, NamedTuple, TypeVar

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.covariance import solve
from debrisest.filters.replay_model import ReplayModel

CONVERGED = 1e-2
"""The predicted decrease of the cost below which the iteration ends."""
_CHUNK = 8  # epochs whose derivatives are held at a time
_FIRST_DAMPING, _LEAST_DAMPING = 0.1, 0.01


class Evidence(NamedTuple):
    """All that is known: prior ``(run, n)`` and its information, measurements and weights.

    `information` is (run, n_e, n_e) in the plain chart; `measured` (run, time, m) is divided by its
    noise, and zero where nothing was `seen`; weights multiply normalised residuals.
    """

    prior: Array
    information: Array
    measured: Array
    seen: BoolArray
    weight: Array


class Linearization(NamedTuple):
    """The cost around a state at epoch 0, as a quadratic form in the plain errors there."""

    state: Array
    """At epoch 0, (run, n)."""
    cost: Array
    information: Array
    gradient: Array
    last_state: Array
    last_sensitivity: Array
    residual: Array
    """Normalised, not weighted, (run, epoch, m); zero where nothing is measured."""


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


def weigh(model: ReplayModel, prior: Array, covariance: Array, measured: Array) -> Evidence:
    """Gather prior ``(run, n)``, its covariance and ``measured (run, time, m)``, NaN = missing."""
    seen = ~np.isnan(measured)
    return Evidence(
        prior=prior,
        information=scaled_inverse(covariance),
        measured=np.where(seen, measured / model.sigma, 0.0),
        seen=seen,
        weight=seen.astype(np.float64),
    )


def linearize(model: ReplayModel, evidence: Evidence, state: Array, last: int) -> Linearization:
    """Linearise the cost of epochs 0 to ``last`` at ``state (run, n)`` of epoch 0."""
    states, sensitivity = model.trajectory(state, 0, last)
    offset = model.plain_difference(evidence.prior, state)
    gradient = (evidence.information @ offset[..., None])[..., 0]
    cost = (offset * gradient).sum(-1)
    information = evidence.information.copy()
    residual = np.empty((len(state), last + 1, evidence.measured.shape[-1]))
    for begin in range(0, last + 1, _CHUNK):
        part = slice(begin, min(begin + _CHUNK, last + 1))
        predicted, derivative = model.rows(
            states[:, part], sensitivity[:, part], 0, np.arange(part.start, part.stop)
        )
        residual[:, part] = evidence.measured[:, part] - predicted / model.sigma
        terms = normal_equations(
            derivative / model.sigma[:, None], residual[:, part], evidence.weight[:, part]
        )
        information += terms[0]
        gradient += terms[1]
        cost += terms[2]
    residual[~evidence.seen[:, : last + 1]] = 0.0
    return Linearization(
        state, cost, information, gradient, states[:, -1], sensitivity[:, -1], residual
    )


def normal_equations(
    derivative: Array, residual: Array, weight: Array
) -> tuple[Array, Array, Array]:
    """``H^T W H``, ``H^T W r`` and ``r^T W r`` per run, of rows ``(run, ..., m, n_e)``."""
    runs, n_e = len(derivative), derivative.shape[-1]
    flat = (weight[..., None] * derivative).reshape(runs, -1, n_e)
    weighted = (weight * residual).reshape(runs, -1, 1)
    transposed = np.swapaxes(flat, -1, -2)
    return transposed @ flat, (transposed @ weighted)[..., 0], (weighted**2).sum((-2, -1))


def gauss_newton(
    model: ReplayModel, evidence: Evidence, state: Array, last: int, iterations: int
) -> Solution:
    """Minimise the cost of epochs 0 to ``last`` from ``state (run, n)`` at epoch 0.

    A step that raises the cost is taken back, and the next one is damped by a part of the prior's
    information (the information itself as a measure stalls in the long valleys of such costs).
    `iterations` counts linearisations; runs stop one by one.
    """
    best = linearize(model, evidence, state, last)
    damping = np.zeros(len(state))
    step, decrement = _step(best, evidence.information, damping)
    active = np.isfinite(best.cost) & ~(decrement < CONVERGED)
    for _ in range(iterations - 1):
        runs = np.flatnonzero(active)
        if len(runs) == 0:
            break
        trial = linearize(
            model, take(evidence, runs), move(model, best.state[runs], step[runs]), last
        )
        better = trial.cost <= best.cost[runs]
        best = put(best, runs[better], take(trial, np.flatnonzero(better)))
        damping[runs] = _next_damping(damping[runs], better)
        step[runs], decrement[runs] = _step(
            take(best, runs), evidence.information[runs], damping[runs]
        )
        active[runs] = ~(decrement[runs] < CONVERGED)
    return Solution(best, step, decrement)


def move(model: ReplayModel, state: Array, step: Array) -> Array:
    """State after a step in plain errors, taken in the state's own chart."""
    return model.retract(state, (model.chart(state) @ step[..., None])[..., 0])


def scaled_solve(matrix: Array, right: Array) -> Array:
    """Solution ``(run, n_e)`` of a positive system whose unknowns differ by orders of magnitude."""
    scale = np.diagonal(matrix, 0, -2, -1) ** -0.5
    scaled = scale[..., :, None] * matrix * scale[..., None, :]
    return scale * solve(scaled, (scale * right)[..., None])[..., 0]


def scaled_inverse(matrix: Array) -> Array:
    """Inverse ``(run, n_e, n_e)`` of such a matrix, symmetric."""
    scale = np.diagonal(matrix, 0, -2, -1) ** -0.5
    both = scale[..., :, None] * scale[..., None, :]
    inverse = solve(both * matrix, np.broadcast_to(np.eye(matrix.shape[-1]), matrix.shape))
    return 0.5 * both * (inverse + np.swapaxes(inverse, -1, -2))


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


Arrays = TypeVar("Arrays", bound=tuple[Any, ...])


def take(arrays: Arrays, runs: IntArray) -> Arrays:
    """Return some runs of all the arrays."""
    return type(arrays)(*(array[runs] for array in arrays))


def put(arrays: Arrays, runs: IntArray, part: Arrays) -> Arrays:
    """Replace some runs of all the arrays, in place."""
    for array, values in zip(arrays, part):
        array[runs] = values
    return arrays
