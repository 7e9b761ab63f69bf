"""Prior and measurements of a whole arc, and their cost around a state at epoch 0.

The cost is twice the negative logarithm of the posterior density: the normalised squares of the
prior's error and of the residuals. Its minimum is the maximum a posteriori estimate.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.replay.normal_equations import normal_equations, point_equations
from debrisest.filters.replay_model import ReplayModel

_RUNS, _EPOCHS = 20, 8
"""Whose derivatives are held at a time, for the sake of the cache."""

Place = tuple[Array, Array, int, IntArray]
"""States, sensitivities, the epoch that these start from, and the epochs: what `rows` takes."""


class MeasuredArc(NamedTuple):
    """All that is known: prior ``(run, n)`` and its information, measurements and weights.

    `information` is (run, n_e, n_e) in the plain chart; `measured` (run, time, m) is divided by its
    noise, and zero where nothing was `seen`; weights multiply normalised residuals.
    """

    prior: Array
    information: Array
    measured: Array
    seen: BoolArray
    weight: Array

    def until(self, last: int) -> "MeasuredArc":
        """Return what is known at epoch ``last``; weights are those of the whole arc."""
        frames = slice(last + 1)
        seen, weight = self.seen[:, frames], self.weight[:, frames]
        return self._replace(measured=self.measured[:, frames], seen=seen, weight=weight)


class Linearization(NamedTuple):
    """The cost around a state at epoch 0, as a quadratic form in the plain errors there."""

    state: Array
    """At epoch 0, (run, n)."""
    cost: Array
    information: Array
    gradient: Array
    last_state: Array
    last_sensitivity: Array


def measured_arc(
    model: ReplayModel, prior: Array, covariance: Array, measured: Array
) -> MeasuredArc:
    """Gather prior ``(run, n)``, its covariance and ``measured (run, time, m)``, NaN = missing."""
    seen = ~np.isnan(measured)
    return MeasuredArc(
        prior=prior,
        information=scaled_inverse(covariance),
        measured=np.where(seen, measured / model.sigma, 0.0),
        seen=seen,
        weight=seen.astype(np.float64),
    )


def residuals(model: ReplayModel, arc: MeasuredArc, shown: Array) -> Array:
    """Normalised residuals of what is ``shown (run, epoch, m)`` from epoch 0 on, not weighted.

    They are zero where nothing is measured.
    """
    epochs = slice(shown.shape[1])
    residual = arc.measured[:, epochs] - shown / model.sigma
    return np.where(arc.seen[:, epochs], residual, 0.0)


def linearize(model: ReplayModel, arc: MeasuredArc, state: Array, last: int) -> Linearization:
    """Linearise the cost of epochs 0 to ``last`` at ``state (run, n)`` of epoch 0."""
    states, sensitivity = model.trajectory(state, 0, last)
    offset = model.plain_difference(arc.prior, state)
    gradient = (arc.information @ offset[..., None])[..., 0]
    cost = (offset * gradient).sum(-1)
    known = arc.until(last)
    terms = _in_blocks(model, states, sensitivity, known.measured, known.weight)
    return Linearization(
        state=state.copy(),
        cost=cost + terms[2],
        information=arc.information + terms[0],
        gradient=gradient + terms[1],
        last_state=states[:, -1].copy(),
        last_sensitivity=sensitivity[:, -1].copy(),
    )


def _in_blocks(
    model: ReplayModel, states: Array, sensitivity: Array, measured: Array, weight: Array
) -> tuple[Array, ...]:
    """`sums` of all epochs from 0 on."""
    runs, epochs = measured.shape[:2]
    if model.sums is not None:
        return model.sums(states, sensitivity, 0, np.arange(epochs), measured, weight)
    n_e = len(model.error_names)
    information, gradient, cost = np.zeros((runs, n_e, n_e)), np.zeros((runs, n_e)), np.zeros(runs)
    for begin in range(0, runs, _RUNS):
        part = model.of(np.arange(begin, min(begin + _RUNS, runs)))
        for first in range(0, epochs, _EPOCHS):
            block = np.arange(first, min(first + _EPOCHS, epochs))
            some = slice(begin, begin + _RUNS), slice(first, first + _EPOCHS)
            at = states[some], sensitivity[some], 0, block
            terms = sums(part, at, measured[some], weight[some])
            information[some[0]] += terms[0]
            gradient[some[0]] += terms[1]
            cost[some[0]] += terms[2]
    return information, gradient, cost


def sums(model: ReplayModel, at: Place, measured: Array, weight: Array) -> tuple[Array, ...]:
    """Information (run, n_e, n_e), gradient (run, n_e) and cost (run,) of some epochs.

    They are by the plain errors of the epoch that `at` starts from.
    """
    if model.sums is not None:
        return model.sums(*at, measured, weight)
    if model.point_rows is None:
        predicted, derivative = model.rows(*at)
        residual = measured - predicted / model.sigma
        return normal_equations(derivative / model.sigma[:, None], residual, weight)
    rows = model.point_rows(*at)
    residual = measured - rows.shown / model.sigma
    return point_equations(rows, residual, weight, weight / model.sigma)
