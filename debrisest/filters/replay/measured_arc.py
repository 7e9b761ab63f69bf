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
    """Normalised residuals of what is ``shown (run, epoch, m)`` from epoch 0 on, as `linearize`."""
    epochs = slice(shown.shape[1])
    residual = arc.measured[:, epochs] - shown / model.sigma
    return np.where(arc.seen[:, epochs], residual, 0.0)


def linearize(model: ReplayModel, arc: MeasuredArc, state: Array, last: int) -> Linearization:
    """Linearise the cost of epochs 0 to ``last`` at ``state (run, n)`` of epoch 0."""
    states, sensitivity = model.trajectory(state, 0, last)
    offset = model.plain_difference(arc.prior, state)
    gradient = (arc.information @ offset[..., None])[..., 0]
    cost = (offset * gradient).sum(-1)
    information = arc.information.copy()
    residual = np.empty((len(state), last + 1, arc.measured.shape[-1]))
    for begin in range(0, len(state), _RUNS):
        runs = np.arange(begin, min(begin + _RUNS, len(state)))
        part = model.of(runs)
        for first in range(0, last + 1, _EPOCHS):
            epochs = np.arange(first, min(first + _EPOCHS, last + 1))
            some = slice(begin, begin + _RUNS), slice(first, first + len(epochs))
            residual[some], *terms = _sums(
                part,
                (states[some], sensitivity[some], 0, epochs),
                arc.measured[some],
                arc.weight[some],
            )
            information[some[0]] += terms[0]
            gradient[some[0]] += terms[1]
            cost[some[0]] += terms[2]
    residual[~arc.seen[:, : last + 1]] = 0.0
    return Linearization(
        state=state.copy(),
        cost=cost,
        information=information,
        gradient=gradient,
        last_state=states[:, -1].copy(),
        last_sensitivity=sensitivity[:, -1].copy(),
        residual=residual,
    )


def _sums(model: ReplayModel, at: Place, measured: Array, weight: Array) -> tuple[Array, ...]:
    """Normalised residuals of some epochs, and their normal equations."""
    if model.point_rows is None:
        predicted, derivative = model.rows(*at)
        residual = measured - predicted / model.sigma
        return residual, *normal_equations(derivative / model.sigma[:, None], residual, weight)
    rows = model.point_rows(*at)
    residual = measured - rows.shown / model.sigma
    return residual, *point_equations(rows, residual, weight, weight / model.sigma)
