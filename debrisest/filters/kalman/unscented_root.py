"""Unscented Kalman filter by a triangular root of the covariance, as compiled loops."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.linear_algebra import square_root
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
    Neither the covariance nor that of the innovation is formed, so that none has to be repaired.
    """
    epochs = measurements.shape[1]
    writer = EstimatesWriter(model.error_names, state, covariance, epochs, keep, totals=["repairs"])
    going = writer.runs
    state, (root, repaired) = state[going], square_root(covariance[going])
    columns, repairs = np.ascontiguousarray(np.swapaxes(root, -2, -1)), repaired.astype(np.int64)
    noise = _root_of_noise(model.process_noise)
    with np.errstate(all="ignore"):
        for k in range(epochs):
            if k > 0:
                state = _predict(steps, rule, state, columns, noise)
            y = measurements[going, k]
            state, variance, nis = _update(model, steps, rule, state, columns, y)
            spread = np.swapaxes(columns, -2, -1) @ columns if writer.keeps(k) else variance
            figures = {"nis": nis, "nis_dof": (~np.isnan(y)).sum(-1), "repairs": repairs}
            left = writer.record(k, state, spread, figures)
            if len(left) < len(going):
                going, state, columns = going[left], state[left], columns[left]
            repairs = np.zeros(len(going), dtype=np.int64)
    return writer.estimates()


def _root_of_noise(noise: Array) -> Array:
    """Columns (c, n) whose squares add up to a covariance, none for what has none."""
    values, vectors = np.linalg.eigh(noise)
    return np.asarray((np.sqrt(np.maximum(values, 0.0)) * vectors).T[values > 0.0])


def _predict(
    steps: PairedSteps, rule: PairRule, state: Array, columns: Array, noise: Array
) -> Array:
    """Return the mean one step later, and replace the columns by its own."""
    from debrisest.filters.kalman.root_prediction_loops import fold

    loose = steps.move(state, columns, rule.scale)
    own = loose.shape[1] // 2
    even = loose[:, own:]
    state = state + even.sum(1) / rule.scale
    loose[:, own:] = rule.leaned(even)
    if len(noise):
        loose = np.concatenate([loose, np.tile(noise, (len(loose), 1, 1))], axis=1)
    fold(columns, loose, own)
    return state


def _update(
    model: Model, steps: PairedSteps, rule: PairRule, state: Array, columns: Array, y: Array
) -> tuple[Array, Array, Array]:
    """Return the corrected state, its variances and NIS, and update the columns."""
    from debrisest.filters.kalman.root_update_loops import correct

    shown, odd, even = steps.show(state, columns, rule.scale)
    innovation = model.innovation(y, shown + even.sum(1) / rule.scale)
    even = rule.leaned(even)
    noise = model.measurement_noise + np.swapaxes(even, -2, -1) @ even
    correction, variance, nis = correct(columns, odd, noise, innovation)
    return model.retract(state, correction), variance, nis
