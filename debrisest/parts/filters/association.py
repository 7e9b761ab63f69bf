"""Filters of unlabelled detections that a scenario can name, and their bound."""

from collections.abc import Iterator
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from debrisest.filters.association.evidence import score_correlation, score_sigma
from debrisest.filters.association.restless import log_ratio
from debrisest.filters.association.self_tests import (
    agitation_test,
    companion_test,
    crowd_test,
    missed_test,
)
from debrisest.filters.association.single import associated, jointly_associated
from debrisest.filters.association.weights import Validation, inverse_unit_ball, unit_ball
from debrisest.filters.estimates import Estimates
from debrisest.filters.scan_model import ScanModel
from debrisest.filters.self_test import innovation_test, score_test, scores_test
from debrisest.filters.verdict import SelfTest, told
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.roles import FilterPart, Given, Positive

_LINEARISED_ONCE = (
    "linearised about the first guess for good, and what that costs is in no covariance; "
    "relinearised_s, or linearised: estimate, corrects it"
)
Probability = Annotated[float, Field(gt=0, le=1)]


class _Validating(FilterPart):
    """Keys of the filters that have to tell the target from clutter."""

    version = 6
    takes = "scan_model"
    runs_together = 200
    gate: Positive = 9.21
    """Largest squared distance of a detection from the predicted one, in sigmas; of two components,
    9.21 lets 99 % pass, 5 lets 92 % pass."""
    detection_probability: Probability = 0.99
    """Probability that a target gives a detection in a sensor's scan."""
    gate_probability: Probability | None = None
    """Probability that the target's detection is within the gate; by default what chi-square
    says."""
    gate_volume: Literal["unit_ball", "inverse_unit_ball"] = "unit_ball"
    """Volume by which the clutter in the gate is spread, for the weight of "none of them is the
    target's": the unit ball's, or its inverse, a misprint of Li et al. that weighs 10 times as
    much."""
    gate_dimension: Annotated[int, Field(ge=1)] | None = None
    """Dimension of a detection in that weight; none: what it is, 2 of a pixel."""
    stacked: bool = False
    """All sensors update with one gain, instead of one after the other."""
    keep_s: KeptTimes = []

    @property
    def validation(self) -> Validation:
        """What the numerics call these keys."""
        ball = unit_ball if self.gate_volume == "unit_ball" else inverse_unit_ball
        return Validation(
            self.gate,
            self.detection_probability,
            self.gate_probability,
            ball,
            self.gate_dimension,
        )


class AssociationFilter(_Validating):
    """A target whose detections come unlabelled, among clutter."""

    kind: Literal["association"]
    method: Literal["probabilistic", "nearest"] = "probabilistic"
    """Use each detection within the gate with its probability to be the target's, or the nearest as
    if it were certain."""
    linearised: Literal["estimate", "start", "truth"] = "estimate"
    """About what it is linearised: the prediction; the start, propagated and never corrected; the
    truth (nothing that one could use)."""
    relinearised_s: Positive | None = None
    """With `linearised: start`, move to the estimate every so often."""
    process_noise: Literal["stated", "stated_or_more"] = "stated"
    """With `stated_or_more`, three times the stated one is taken to be as likely before the data:
    the estimate is the mixture of both, and errors stay within their sigmas where more is at work
    than the data can tell; they are a few percent larger where it is not."""

    @property
    def uses_truth(self) -> bool:
        """Return whether it is linearised at the truth."""
        return self.linearised == "truth"

    @model_validator(mode="after")
    def _relinearised_from_the_start(self) -> Self:
        if self.relinearised_s is not None and self.linearised != "start":
            raise ValueError("relinearised_s goes with linearised: start")
        return self

    def run(self, model: ScanModel, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
        found = associated(
            *(model, given.state, given.covariance, given.measured, self.validation),
            method=self.method,
            stacked=self.stacked,
            relinearise=self._every(given.clock.step),
            truth=given.known_truth if self.linearised == "truth" else None,
            restless=self.process_noise == "stated_or_more",
            keep=kept_epochs(self.keep_s, given.clock),
        )
        certain, once = self.method == "nearest", self._every(1.0) == 0
        return _unlabelled(model, found, self.validation, certain, once)

    def _every(self, step: float) -> int:
        if self.linearised == "estimate":
            return 1
        return 0 if self.relinearised_s is None else max(1, round(self.relinearised_s / step))


class JointAssociation(_Validating):
    """A target among other pieces that are tracked as well, each detection that of one at most."""

    takes = "tracks_model"
    kind: Literal["joint_association"]

    def run(self, model: ScanModel, given: Given) -> Estimates:
        """Return the estimates of the target; the state given is (run, track, n)."""
        found = jointly_associated(
            *(model, given.state, given.covariance, given.measured, self.validation),
            stacked=self.stacked,
            keep=kept_epochs(self.keep_s, given.clock),
        )
        return _unlabelled(model, found, self.validation)


class KnownAssociation(FilterPart):
    """The extended Kalman filter that is handed the target's own detections."""

    takes = "scan_model"
    version = 4
    runs_together = 200
    kind: Literal["known_association"]
    keep_s: KeptTimes = []

    def run(self, model: ScanModel, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
        found = associated(
            *(model, given.state, given.covariance, given.measured, Validation()),
            method="known",
            keep=kept_epochs(self.keep_s, given.clock),
        )
        tests = [innovation_test(found.nis, found.nis_dof), *_scores(model, found)]
        tests += _scores_together(model, found)
        return told(counting(found, "repairs"), tests)


def _unlabelled(
    model: ScanModel,
    found: Estimates,
    validation: Validation,
    certain: bool = False,
    once: bool = False,
) -> Estimates:
    """Without NIS, which is not chi-square where detections are chosen by their distance.

    That only makes it smaller: what is too large for a chi-square says so all the same. The choice
    may be taken for `certain`, the model be linearised `once`.
    """
    count = {name: values.sum(-1) for name, values in found.counts.items()}
    likely = validation.detection_probability * validation.passing(2)
    tests = [
        missed_test(count["matched"], count["looked"], likely),
        innovation_test(found.nis, found.nis_dof),
        companion_test(count["near"], count["ring"]),
        *_scores(model, found),
    ]
    if certain:
        tests.append(crowd_test(count["mistaken"], count["looked"]))
    else:
        tests += _scores_together(model, found)
    if once:
        tests.append(SelfTest(np.ones(len(found.state)), 0.0, _LINEARISED_ONCE))
    without = counting(found, "repairs", "validated")._replace(
        nis=np.full_like(found.nis, np.nan), nis_dof=np.zeros_like(found.nis_dof)
    )
    return told(without, tests)


def _scores(model: ScanModel, found: Estimates) -> Iterator[SelfTest]:
    """What the innovations go with: each doubt, and more process noise than the model has."""
    counts = found.counts
    stated = np.diagonal(counts["information"], 0, -2, -1)
    with np.errstate(all="ignore"):
        size = counts["score"] / stated
        sigma = score_sigma(counts["square"], counts["information"]) / stated
    for i, doubt in enumerate(model.doubts):
        yield score_test(size[:, i], sigma[:, i], doubt.reason, doubt.scale)
    yield agitation_test(log_ratio(counts["likelihood"]))


def _scores_together(model: ScanModel, found: Estimates) -> list[SelfTest]:
    """All doubts at once; wrong picks that are taken for certain pull on all of them."""
    if not model.doubts:
        return []
    information = found.counts["information"]
    sigma = score_sigma(found.counts["square"], information)
    return [scores_test(found.counts["score"] / sigma, score_correlation(information))]


def counting(found: Estimates, *names: str) -> Estimates:
    """Return them with these of their counts only."""
    return found._replace(counts={name: found.counts[name] for name in names})
