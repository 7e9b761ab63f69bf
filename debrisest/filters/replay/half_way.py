"""The joint error of a replay, taken half way to the epoch that it speaks of.

A motion is told by what was seen at all epochs since the first, and how these depend on the errors
of one epoch bends with the square of the time to it: with the errors of the middle a quarter as
much as with those of either end. There the errors are nearly normal, together too, as no single
covariance of the end can say. It is the same motion, and the same information.
"""

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.linear_algebra import scaled_inverse
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.rivals import squared_distance


def half_way(measured: Array, last: int) -> int:
    """Return the epoch between the first that any run measured, (run, time, m), and ``last``."""
    seen = ~np.isnan(measured).all((0, 2))
    return (min(int(seen.argmax()), last) + last) // 2


def moved(
    model: ReplayModel, state: Array, spread: Array, epoch: int, to: int
) -> tuple[Array, Array]:
    """Return states (run, n) and plain covariances (run, n_e, n_e) of an epoch at another one."""
    states, sensitivity = model.trajectory(state, epoch, to)
    transition = model.transition(sensitivity[:, -1], epoch, to)
    return states[:, -1], transition @ spread @ np.swapaxes(transition, -1, -2)


def joint_square(model: ReplayModel, state: Array, spread: Array, truth: Array) -> Array:
    """Return the square (run,) of the error in sigmas, in the state's own chart."""
    chart = model.chart(state)
    own = chart @ spread @ np.swapaxes(chart, -1, -2)
    return squared_distance(model.difference(truth, state), scaled_inverse(own))
