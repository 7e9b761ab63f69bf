"""The estimator at the bound for a torque-free body: least squares over everything at once."""

from typing import Literal

from debrisest.batch.motion_model import MotionModel
from debrisest.filters.estimates import Estimates
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.problems.tumbling.motion_estimates import estimates
from debrisest.roles import FilterPart, Given


class Batch(FilterPart):
    """Starts by itself, is tested by chi-square and by blocks, and falls back to a smoother.

    Where torque-free motion does not hold, attitude and rate come from a smoother that assumes no
    law of motion, and no inertia is claimed; the status says which it was.
    """

    takes = "motion_model"
    makes_start = True
    kind: Literal["batch"]
    keep_s: KeptTimes = []

    def run(self, model: MotionModel, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
        kept = sorted({*kept_epochs(self.keep_s, given.clock), len(model.times) - 1})
        motions = [model.estimate(run) for run in range(model.runs)]
        return estimates(motions, model.times, given.measured, kept)
