"""The estimator at the bound for a torque-free body: least squares over everything at once."""

from collections.abc import Sequence
from typing import Literal

from debrisest.batch.motion_model import Estimate, MotionModel
from debrisest.batch.online import Stretch, online
from debrisest.filters.estimates import Estimates
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.problems.tumbling.motion_estimates import estimates
from debrisest.roles import FilterPart, Given


class Batch(FilterPart):
    """Starts by itself, is tested by chi-square and by blocks, and falls back to a smoother.

    Where torque-free motion does not hold, attitude and rate come from a smoother that assumes no
    law of motion, and no inertia is claimed; the status says which it was. Online, every epoch is
    estimated from what was measured up to it.
    """

    takes = "motion_model"
    version = 6
    makes_start = True
    kind: Literal["batch"]
    online: bool = False
    """Every epoch is estimated from what was measured up to it: the batch is run again every 10 s,
    later every tenth of the time so far, and the motion predicted in between. Nothing is known
    before the first run. Status and figures per run are those of all data. Needs known geometry."""
    keep_s: KeptTimes = []

    def run(self, model: MotionModel, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
        if self.online and not model.frame_is_given:
            raise ValueError(
                "online needs known geometry: with unknown points every run over the data so far "
                "names body axes of its own; leave out online, or give the points"
            )
        kept = sorted({*kept_epochs(self.keep_s, given.clock), len(model.times) - 1})
        runs = [self._stretches(model, model.estimate(run)) for run in range(model.runs)]
        return estimates(runs, model.times, given.measured, kept)

    def _stretches(self, model: MotionModel, estimate: Estimate) -> Sequence[Stretch]:
        if self.online:
            return list(online(estimate, model.times))
        motion = estimate(len(model.times), None, None)
        return [Stretch(motion, motion.path)]
