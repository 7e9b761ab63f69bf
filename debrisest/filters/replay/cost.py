"""Cost of a whole motion."""

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.replay.measured_arc import MeasuredArc
from debrisest.filters.replay_model import ReplayModel


def cost_of(model: ReplayModel, arc: MeasuredArc, state: Array, last: int) -> Array:
    """Cost ``(run,)`` of epochs 0 to ``last`` of the motion from ``state (run, n)`` at epoch 0."""
    states, sensitivity = model.trajectory(state, 0, last)
    predicted, _ = model.rows(states, sensitivity, 0, np.arange(last + 1))
    frames = slice(last + 1)
    residual = arc.weight[:, frames] * (arc.measured[:, frames] - predicted / model.sigma)
    offset = model.plain_difference(arc.prior, state)[..., None]
    prior = np.swapaxes(offset, -1, -2) @ arc.information @ offset
    return np.asarray(prior[:, 0, 0] + (residual**2).sum((-2, -1)))
