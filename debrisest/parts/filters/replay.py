"""Estimators at the bound, and the bound itself, for motions that follow from their start."""

from typing import Annotated, Literal

from pydantic import Field

from debrisest.filters.estimates import Estimates
from debrisest.filters.replay.hindsight import with_hindsight
from debrisest.filters.replay.replay import RATIO, replay, smooth
from debrisest.filters.replay.self_tests import self_tests
from debrisest.filters.replay.valley import with_bends
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.status import ReplayStatus
from debrisest.filters.verdict import told
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.roles import FilterPart, Given


class Replay(FilterPart):
    """Maximum a posteriori at every epoch of all measurements so far, or of all there are."""

    version = 6
    takes = "replay_model"
    runs_together = 100
    kind: Literal["replay"]
    smoother: bool = False
    """Estimate from all measurements, later ones too."""
    gate: bool = False
    """Leave out measurements that are too unlikely; what was rejected is judged again at each
    replay."""
    ratio: Annotated[float, Field(ge=1)] = RATIO
    """Ratio of the times of successive replays; 1 replays at each epoch."""
    keep_s: KeptTimes = []

    def run(self, model: ReplayModel, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
        known = given.state, given.covariance, given.measured
        keep = kept_epochs(self.keep_s, given.clock)
        truth = None if given.truth is None else given.truth[:, 0]
        found = replay(model, *known, ratio=self.ratio, gate=self.gate, keep=keep, reference=truth)
        if self.smoother:
            found = smooth(model, *known, found, gate=self.gate, keep=keep, reference=truth)
        found = with_bends(model, *known, found, self.gate, self.smoother, given.truth)
        converged = found.status == ReplayStatus.CONVERGED.sentence
        tests = self_tests(model, *known, found, self.gate)
        found = told(found._replace(counts=found.counts | {"converged": converged}), tests)
        return found if self.smoother else with_hindsight(model, found)
