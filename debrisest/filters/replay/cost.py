"""Cost of a motion beside the estimate's, at any epoch, by the weights the estimate has then."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.replay.measured_arc import MeasuredArc, residuals
from debrisest.filters.replay_model import ReplayModel


class Reference(NamedTuple):
    """A motion that the measurements are compared with, run first."""

    prior: Array
    """What its start adds to the cost, (run,)."""
    residual: Array
    """Normalised, (run, time, m); zero where nothing is measured."""

    def cost(self, weight: Array, last: int) -> Array:
        """Cost ``(run,)`` of the epochs up to ``last``, of measurements of ``weight``."""
        frames = slice(last + 1)
        weighted = weight[:, frames] * self.residual[:, frames]
        return np.asarray(self.prior + (weighted**2).sum((-2, -1)))


def reference_of(model: ReplayModel, arc: MeasuredArc, state: Array) -> Reference:
    """Return the motion from ``state (run, n)`` at epoch 0."""
    offset = model.plain_difference(arc.prior, state)[..., None]
    prior = np.swapaxes(offset, -1, -2) @ arc.information @ offset
    _, shown = model.shown(state, arc.measured.shape[1] - 1)
    return Reference(prior[:, 0, 0], residuals(model, arc, shown))
