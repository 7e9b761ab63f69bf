"""Filters of unlabelled detections that a scenario can name, and their bound."""

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Array
from debrisest.filters.association.scan_model import ScanModel
from debrisest.filters.association.single import associated, jointly_associated
from debrisest.filters.association.weights import Misses, Validation
from debrisest.filters.history import History
from debrisest.parts.filters.filtered import filtered
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.roles import Filtered, FilterPart, Given, Positive

Probability = Annotated[float, Field(gt=0, le=1)]


class _Validating(FilterPart):
    """Keys of the filters that have to tell the target from clutter."""

    version = 2
    takes = "scan_model"
    gate: Positive = 9.21
    detection_probability: Probability = 0.99
    gate_probability: Probability | None = None
    misses: Misses = "corrected"
    stacked: bool = False
    keep_s: KeptTimes = []

    @property
    def validation(self) -> Validation:
        """What the numerics call these keys."""
        return Validation(self.gate, self.detection_probability, self.misses, self.gate_probability)


class AssociationFilter(_Validating):
    """A target whose detections come unlabelled, among clutter."""

    kind: Literal["association"]
    method: Literal["probabilistic", "nearest"] = "probabilistic"
    linearised: Literal["estimate", "start", "truth"] = "estimate"
    relinearised_s: Positive | None = None

    @property
    def uses_truth(self) -> bool:
        """Return whether it is linearised at the truth."""
        return self.linearised == "truth"

    @model_validator(mode="after")
    def _relinearised_from_the_start(self) -> Self:
        if self.relinearised_s is not None and self.linearised != "start":
            raise ValueError("relinearised_s goes with linearised: start")
        return self

    def run(self, model: ScanModel, given: Given) -> Filtered:
        """Return the estimates of all epochs."""
        history = associated(
            *(model, given.state, given.covariance, given.measured, self.validation),
            method=self.method,
            stacked=self.stacked,
            relinearise=self._every(given.clock.step),
            truth=_truth(given) if self.linearised == "truth" else None,
            keep=kept_epochs(self.keep_s, given.clock),
        )
        return _unlabelled(history)

    def _every(self, step: float) -> int:
        if self.linearised == "estimate":
            return 1
        return 0 if self.relinearised_s is None else max(1, round(self.relinearised_s / step))


class JointAssociation(_Validating):
    """A target among other pieces that are tracked as well, each detection that of one at most."""

    takes = "tracks_model"
    kind: Literal["joint_association"]

    def run(self, model: ScanModel, given: Given) -> Filtered:
        """Return the estimates of the target; the state given is (run, track, n)."""
        history = jointly_associated(
            *(model, given.state, given.covariance, given.measured, self.validation),
            stacked=self.stacked,
            keep=kept_epochs(self.keep_s, given.clock),
        )
        return _unlabelled(history)


class KnownAssociation(FilterPart):
    """The extended Kalman filter that is handed the target's own detections."""

    takes = "scan_model"
    kind: Literal["known_association"]
    keep_s: KeptTimes = []

    def run(self, model: ScanModel, given: Given) -> Filtered:
        """Return the estimates of all epochs."""
        history = associated(
            *(model, given.state, given.covariance, given.measured, Validation()),
            method="known",
            keep=kept_epochs(self.keep_s, given.clock),
        )
        return filtered(history)


class LinearisedAtTruth(FilterPart):
    """The posterior bound along each run (Tichavsky et al. 1998) as an estimator.

    Known detections, linearised at the truth.
    """

    takes = "scan_model"
    needs_truth = True
    kind: Literal["linearised_at_truth"]
    keep_s: KeptTimes = []

    def run(self, model: ScanModel, given: Given) -> Filtered:
        """Return the truth moved by the errors of the efficient estimator."""
        history = associated(
            *(model, given.state, given.covariance, given.measured, Validation()),
            method="known",
            truth=_truth(given),
            keep=kept_epochs(self.keep_s, given.clock),
        )
        return filtered(history)


def _truth(given: Given) -> Array:
    if given.truth is None:
        raise ValueError("this filter is linearised at the truth, which is not known here")
    return given.truth


def _unlabelled(history: History) -> Filtered:
    """Without NIS, which is not chi-square where detections are chosen by their distance."""
    return filtered(history, validated=history.validated)._replace(
        nis=np.full_like(history.nis, np.nan), nis_dof=np.zeros_like(history.nis_dof)
    )
