"""Estimators at the bound, and the bound itself, for motions that follow from their start."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from debrisest.arrays import Data
from debrisest.assessment.bound import paired_errors
from debrisest.filters.replay.estimates import ReplayStatus
from debrisest.filters.replay.replay import RATIO, replay, smooth
from debrisest.filters.replay.replay_model import ReplayModel
from debrisest.outcome import sentences
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.roles import Filtered, FilterPart, Given


class Replay(FilterPart):
    """Maximum a posteriori at every epoch of all measurements so far, or of all there are."""

    version = 2
    takes = "replay_model"
    kind: Literal["replay"]
    smoother: bool = False
    gate: bool = False
    ratio: Annotated[float, Field(ge=1)] = RATIO
    keep_s: KeptTimes = []

    def run(self, model: ReplayModel, given: Given) -> Filtered:
        """Return the estimates of all epochs."""
        known = given.state, given.covariance, given.measured
        keep = kept_epochs(self.keep_s, given.clock)
        beside = None if given.truth is None else given.truth[:, 0]
        found = replay(model, *known, ratio=self.ratio, gate=self.gate, keep=keep, beside=beside)
        counts: Data = {"rejected": found.rejected} if self.gate else {}
        if self.smoother:
            found = smooth(model, *known, found, gate=self.gate, keep=keep, beside=beside)
        counts |= {"cost": found.cost}
        if beside is not None:
            counts |= {"cost_of_truth": found.cost_beside}
        return Filtered(
            *(found.state, found.sigma, found.covariance, found.kept, found.nis, found.nis_dof),
            status=sentences(found.status, ReplayStatus),
            counts=counts | {"converged": found.status == ReplayStatus.CONVERGED},
        )


class Efficient(FilterPart):
    """The Cramer-Rao bound as an estimator: linearised at the truth, fed with the same data."""

    takes = "replay_model"
    needs_truth = True
    kind: Literal["efficient"]
    smoother: bool = False
    keep_s: KeptTimes = []

    def run(self, model: ReplayModel, given: Given) -> Filtered:
        """Return the truth moved by the errors of the efficient estimator."""
        if given.truth is None:
            raise ValueError("the bound is linearised at the truth, which is not known here")
        runs, epochs = given.measured.shape[:2]
        kept = sorted({*kept_epochs(self.keep_s, given.clock), epochs - 1})
        errors = paired_errors(
            model, given.truth[:, 0], given.state, given.covariance[0], given.measured, kept
        )
        error, sigma, covariance = errors[3:] if self.smoother else errors[:3]
        chart = model.chart(given.truth)
        state = model.displace(given.truth, (chart @ error[..., None])[..., 0])
        to_state = model.inverse_chart(state[:, kept]) @ chart[:, kept]
        return Filtered(
            state=state,
            sigma=sigma,
            covariance=to_state @ covariance @ np.swapaxes(to_state, -1, -2),
            kept=np.array(kept, dtype=np.int64),
            nis=np.full((runs, epochs), np.nan),
            nis_dof=np.zeros((runs, epochs), dtype=np.int64),
            status=np.array(["linearised at the truth"] * runs),
        )
