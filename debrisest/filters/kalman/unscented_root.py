"""Unscented Kalman filter by a triangular root of the covariance."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.kalman.root import columns_of, correct, fold, gram
from debrisest.filters.model import Model, PairedSteps


class PairRule(NamedTuple):
    """How far the points of a pair are from the state, in sigma, and how the central one weighs."""

    scale: float
    central: float
    """beta - alpha^2: its weight in a covariance, where that of a mean makes all add up to 1."""

    def positive(self, count: int) -> bool:
        """Return whether a covariance is positive whatever bends."""
        return self.central * count / self.scale**2 > -1.0 - 1e-9

    def leaned(self, even: Array) -> Array:
        """Return half sums (run, c, m) whose squares add up to what bends a covariance.

        Their own are those of deviations from the central point, not from the mean.
        """
        count = even.shape[1]
        lean = np.sqrt(max(0.0, 1.0 + self.central * count / self.scale**2)) - 1.0
        return np.asarray(even + lean / count * even.sum(1, keepdims=True))


def unscented_root(
    model: Model,
    steps: PairedSteps,
    rule: PairRule,
    state: Array,
    covariance: Array,
    measurements: Array,
    keep: Sequence[int] = (),
) -> Estimates:
    """Filter a batch of runs as `unscented` does, which redraws its points.

    Pairs of points at a distance of ``scale`` columns of the root move and are seen as half
    differences, whose squares are a covariance, and half sums, whose squares are what bends.
    """
    epochs = measurements.shape[1]
    writer = EstimatesWriter(model.error_names, state, covariance, epochs, keep, totals=["repairs"])
    going, noise = writer.runs, _root_of_noise(model.process_noise)
    with np.errstate(all="ignore"):
        state, (columns, repairs) = state[going], columns_of(covariance[going])
        for k in range(epochs):
            if k > 0:
                state, repaired = _predict(steps, rule, state, columns, noise)
                repairs += repaired
            y = measurements[going, k]
            state, variance, nis, repaired = _update(model, steps, rule, state, columns, y)
            spread = gram(columns) if writer.keeps(k) else variance
            figures = {"nis": nis, "nis_dof": (~np.isnan(y)).sum(-1), "repairs": repairs}
            left = writer.record(k, state, spread, figures)
            repairs = repaired[left]
            if len(left) < len(going):
                going, state, columns = going[left], state[left], columns[left]
    return writer.estimates()


def _root_of_noise(noise: Array) -> Array:
    """Columns (c, n) whose squares add up to a covariance, none for what has none."""
    values, vectors = np.linalg.eigh(noise)
    return np.asarray((np.sqrt(np.maximum(values, 0.0)) * vectors).T[values > 0.0])


def _predict(
    steps: PairedSteps, rule: PairRule, state: Array, columns: Array, noise: Array
) -> tuple[Array, IntArray]:
    """Return the mean one step later and repairs (run,), and replace the columns by its own."""
    loose = steps.move(state, columns, rule.scale)
    own = loose.shape[1] // 2
    even = loose[:, own:]
    state = state + even.sum(1) / rule.scale
    loose[:, own:] = rule.leaned(even)
    if len(noise):
        loose = np.concatenate([loose, np.tile(noise, (len(loose), 1, 1))], axis=1)
    return state, fold(columns, loose, own)


def _update(
    model: Model, steps: PairedSteps, rule: PairRule, state: Array, columns: Array, y: Array
) -> tuple[Array, Array, Array, IntArray]:
    """Return the corrected state, its variances, NIS and repairs, and update the columns."""
    shown, odd, even = steps.show(state, columns, rule.scale)
    innovation = model.innovation(y, shown + even.sum(1) / rule.scale)
    even = rule.leaned(even)
    noise = model.measurement_noise + gram(even)
    correction, variance, nis, repaired = correct(columns, odd, noise, innovation)
    return model.retract(state, correction), variance, nis, repaired
