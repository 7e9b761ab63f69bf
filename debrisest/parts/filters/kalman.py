"""Kalman filters of labelled measurements: unscented, extended, iterated."""

from typing import Annotated, Literal

from pydantic import Field

from debrisest.clock import Clock
from debrisest.filters.estimates import Estimates
from debrisest.filters.gate import Gate
from debrisest.filters.kalman.extended import extended
from debrisest.filters.kalman.unscented import UnscentedParameters, unscented
from debrisest.filters.model import Model
from debrisest.filters.self_test import innovation_test
from debrisest.filters.verdict import told
from debrisest.roles import FilterPart, Given, NonNegative, Positive

KeptTimes = Annotated[
    list[NonNegative],
    Field(
        description="Times, up to the scenario's end; the epochs nearest to them keep their "
        "covariance, beside the last. `nees` and `w` need them."
    ),
]


def kept_epochs(times: list[float], clock: Clock) -> list[int]:
    """Return the epochs nearest to the times, without those after the end."""
    return sorted({clock.nearest(time) for time in times if clock.reaches(time)})


class Unscented(FilterPart):
    """The unscented Kalman filter; on a linear model the Kalman filter, unless not redrawn."""

    version = 2
    takes = "model"
    runs_together = 100
    kind: Literal["unscented"]
    alpha: Positive = 1.0
    """Spread of the sigma points."""
    beta: float = 2.0
    """Weight of the central point in the covariance; 2 suits a Gaussian."""
    kappa: float = 0.0
    """Second spread."""
    redraw: bool = True
    """Draw new sigma points from the predicted covariance before the update; without, the
    innovation covariance lacks the process noise, as in Biondi et al."""
    keep_s: KeptTimes = []

    def run(self, model: Model, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
        spread = UnscentedParameters(self.alpha, self.beta, self.kappa)
        found = unscented(
            model,
            given.state,
            given.covariance,
            given.measured,
            spread,
            keep=kept_epochs(self.keep_s, given.clock),
            redraw=self.redraw,
        )
        return told(found, [innovation_test(found.nis, found.nis_dof)])


class Extended(FilterPart):
    """The extended Kalman filter, or with more than one iteration the iterated one."""

    version = 2
    takes = "model"
    runs_together = 100
    kind: Literal["extended"]
    iterations: Annotated[int, Field(ge=1)] = 1
    """Most iterations of an update."""
    tolerance: Positive = 1e-2
    """A step below it ends the update."""
    stop: Literal["relative_norm", "scaled"] = "scaled"
    """How a step is measured: by the norm of the state, or each error by its posterior sigma."""
    gate: bool = False
    """Leave out measurements that are too unlikely; a gate that locks everything out is opened
    again."""
    keep_s: KeptTimes = []

    def run(self, model: Model, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
        found = extended(
            model,
            given.state,
            given.covariance,
            given.measured,
            iterations=self.iterations,
            tolerance=self.tolerance,
            stop=self.stop,
            keep=kept_epochs(self.keep_s, given.clock),
            gate=Gate() if self.gate else None,
        )
        return told(found, [innovation_test(found.nis, found.nis_dof)])
