"""Prior and measurements of a whole arc, and their cost around a state at epoch 0.

The cost is twice the negative logarithm of the posterior density: the normalised squares of the
prior's error and of the residuals. Its minimum is the maximum a posteriori estimate.
"""

from math import prod
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.replay_model import ReplayModel

_CHUNK = 8  # epochs whose derivatives are held at a time


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


def linearize(model: ReplayModel, arc: MeasuredArc, state: Array, last: int) -> Linearization:
    """Linearise the cost of epochs 0 to ``last`` at ``state (run, n)`` of epoch 0."""
    states, sensitivity = model.trajectory(state, 0, last)
    offset = model.plain_difference(arc.prior, state)
    gradient = (arc.information @ offset[..., None])[..., 0]
    cost = (offset * gradient).sum(-1)
    information = arc.information.copy()
    residual = np.empty((len(state), last + 1, arc.measured.shape[-1]))
    for begin in range(0, last + 1, _CHUNK):
        part = slice(begin, min(begin + _CHUNK, last + 1))
        predicted, derivative = model.rows(
            states[:, part], sensitivity[:, part], 0, np.arange(part.start, part.stop)
        )
        residual[:, part] = arc.measured[:, part] - predicted / model.sigma
        terms = normal_equations(
            derivative / model.sigma[:, None], residual[:, part], arc.weight[:, part]
        )
        information += terms[0]
        gradient += terms[1]
        cost += terms[2]
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


def normal_equations(
    derivative: Array, residual: Array, weight: Array
) -> tuple[Array, Array, Array]:
    """``H^T W H``, ``H^T W r`` and ``r^T W r`` per run, of rows ``(run, ..., m, n_e)``."""
    runs, rows, n_e = len(derivative), prod(residual.shape[1:]), derivative.shape[-1]
    flat = (weight[..., None] * derivative).reshape(runs, rows, n_e)
    weighted = (weight * residual).reshape(runs, rows, 1)
    transposed = np.swapaxes(flat, -1, -2)
    return transposed @ flat, (transposed @ weighted)[..., 0], (weighted**2).sum((-2, -1))
