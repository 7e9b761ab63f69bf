"""Costs of whole motions: that of an estimate, and of another motion beside it."""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.replay.estimates import Estimates
from debrisest.filters.replay.evidence import Evidence
from debrisest.filters.replay.replay_model import ReplayModel


def cost_of(model: ReplayModel, evidence: Evidence, state: Array, last: int) -> Array:
    """Cost ``(run,)`` of epochs 0 to ``last`` of the motion from ``state (run, n)`` at epoch 0."""
    states, sensitivity = model.trajectory(state, 0, last)
    predicted, _ = model.rows(states, sensitivity, 0, np.arange(last + 1))
    frames = slice(last + 1)
    residual = evidence.weight[:, frames] * (evidence.measured[:, frames] - predicted / model.sigma)
    offset = model.plain_difference(evidence.prior, state)[..., None]
    prior = np.swapaxes(offset, -1, -2) @ evidence.information @ offset
    return np.asarray(prior[:, 0, 0] + (residual**2).sum((-2, -1)))


def write_costs(
    model: ReplayModel,
    result: Estimates,
    epoch: int,
    runs: IntArray,
    evidence: Evidence,
    starts: tuple[Array, Array | None],
) -> None:
    """Write the costs of some runs' two motions, the estimate's and the other, from epoch 0 on.

    ``evidence`` holds those runs only, the other motion all: what the weights leave out counts in
    neither cost.
    """
    estimate, beside = starts
    result.cost[runs, epoch] = cost_of(model, evidence, estimate, epoch)
    if beside is not None:
        result.cost_beside[runs, epoch] = cost_of(model, evidence, beside[runs], epoch)
