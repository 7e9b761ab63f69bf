"""How much more the truth costs than the solution, by which simulations judge it in any chart."""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.landmarks.batch_start import Problem
from debrisest.filters.landmarks.cost import Unknowns
from debrisest.filters.landmarks.residuals import value
from debrisest.filters.landmarks.whole_arc import Arc


def costs(task: Problem, arc: Arc, core: Array, points: Array) -> tuple[Array, Array, IntArray]:
    """Return the costs (run,) of the solution and of the truth, and how many numbers are estimated.

    The truth is a ``core (run, n)`` at epoch 0 and ``points (run, N, 3)``. Both costs are those of
    the frames without what the solution leaves out, and of the points that it tells in the end: one
    that was seen too seldom may have been placed by a false match.
    """
    best = arc.found.best
    told = best.at.placed & arc.anchors[-1].present
    true = Unknowns(task.model.parameters(core), np.where(told[..., None], points, 0.0), told)
    known, last = (task.model, arc.observed, best.prior), arc.anchors[-1].epoch
    found = best.at._replace(placed=told)
    own, other = (value(*known, at, last) for at in (found, true))
    return own, other, task.parameters.shape[-1] + 3 * told.sum(-1)
