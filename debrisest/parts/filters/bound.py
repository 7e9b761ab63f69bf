"""Cramer-Rao bounds as estimators: linearised at the truth, fed with the same data."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from debrisest.arrays import Array
from debrisest.assessment.chi_square import upper_quantile
from debrisest.assessment.consistency import normalized_square
from debrisest.filters.association.single import associated
from debrisest.filters.association.weights import Validation
from debrisest.filters.bound.landmarks import landmark_bound
from debrisest.filters.bound.motion import paired_errors
from debrisest.filters.estimates import Estimates
from debrisest.filters.landmark_model import LandmarkModel, core_of, joined, points_of, split
from debrisest.filters.replay_model import ReplayModel
from debrisest.filters.scan_model import ScanModel
from debrisest.filters.self_test import cost_test, lost_test
from debrisest.filters.verdict import SelfTest, Verdict, judged, told
from debrisest.parts.filters.association import counting
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.roles import FilterPart, Given

_ALLOWED = 0.5
"""Sigmas by which a model may leave the truth: its errors' squares grow by less than a quarter."""
_CHANCE = 1e-6


class Efficient(FilterPart):
    """The Cramer-Rao bound as an estimator: linearised at the truth, fed with the same data."""

    takes = "replay_model"
    needs_truth = True
    runs_together = 100
    kind: Literal["efficient"]
    smoother: bool = False
    """Bound of the smoother."""
    keep_s: KeptTimes = []

    def run(self, model: ReplayModel, given: Given) -> Estimates:
        """Return the truth moved by the errors of the efficient estimator."""
        truth, kept = given.known_truth, _kept(self.keep_s, given)
        errors = paired_errors(
            model, truth[:, 0], given.state, given.covariance[0], given.measured, kept
        )
        error, sigma, covariance = errors[3:] if self.smoother else errors[:3]
        chart = model.chart(truth)
        state = model.displace(truth, (chart @ error[..., None])[..., 0])
        to_state = model.inverse_chart(state[:, kept]) @ chart[:, kept]
        spread = to_state @ covariance @ np.swapaxes(to_state, -1, -2)
        return _judged(_estimates(state, sigma, spread, kept), error[:, -1], covariance[:, -1])


class LandmarkBound(FilterPart):
    """The Cramer-Rao bound as an estimator: linearised at the truth, fed with the same data."""

    version = 3
    takes = "landmark_model"
    needs_truth = True
    kind: Literal["landmark_bound"]
    keep_s: KeptTimes = []

    def run(self, model: LandmarkModel, given: Given) -> Estimates:
        """Return the truth moved by the errors of the efficient estimator."""
        truth, kept = given.known_truth, _kept(self.keep_s, given)
        core, points = core_of(model, truth), points_of(model, truth)
        held, n_c = model.held, model.errors
        bound = landmark_bound(
            model,
            core[:, 0],
            points[:, 0],
            model.parameters(core_of(model, given.state)),
            given.covariance[:, held:, held:],
            split(model, given.measured),
            kept,
        )
        moved = points + bound.error[..., n_c:].reshape(points.shape)
        state = joined(model.retract(core, bound.error[..., :n_c]), moved)
        found = _estimates(state, bound.sigma, bound.covariance, kept)
        off = lost_test(
            _off(model, core, bound.sigma[..., :n_c]) > _ALLOWED,
            "no bound: the model's motion from the true start leaves the true one by more than "
            f"{_ALLOWED} of its sigma; a shorter step, or the model of this motion, is needed",
        )
        return _checked(found, [off, cost_test(bound.squares, bound.dof)])


class LinearisedAtTruth(FilterPart):
    """The posterior bound along each run (Tichavsky et al. 1998) as an estimator.

    Known detections, linearised at the truth.
    """

    takes = "scan_model"
    needs_truth = True
    runs_together = 200
    kind: Literal["linearised_at_truth"]
    keep_s: KeptTimes = []

    def run(self, model: ScanModel, given: Given) -> Estimates:
        """Return the truth moved by the errors of the efficient estimator."""
        found = associated(
            *(model, given.state, given.covariance, given.measured, Validation()),
            method="known",
            truth=given.known_truth,
            keep=kept_epochs(self.keep_s, given.clock),
        )
        error = found.state[:, -1] - given.known_truth[:, -1]
        return _judged(counting(found, "repairs"), error, found.covariance[:, -1])


def _judged(found: Estimates, error: Array, covariance: Array) -> Estimates:
    """Estimates of a bound that say whether their own errors at the end (run, n_e) fit it.

    They do not where the filters' model does not follow the truth: then it bounds nothing.
    """
    n = error.shape[-1]
    test = SelfTest(
        normalized_square(error, covariance) / n,
        float(upper_quantile(_CHANCE, n)) / n,
        "this is no bound: its own squared errors are {value} of what it states, at most {limit} "
        "by chance; the model does not follow the truth",
    )
    return told(found, [test])


def _kept(times: list[float], given: Given) -> list[int]:
    return sorted({*kept_epochs(times, given.clock), given.measured.shape[1] - 1})


def _off(model: LandmarkModel, core: Array, sigma: Array) -> Array:
    """How far (run,) the model's motion leaves the true cores (run, time, n), in sigma."""
    start, _ = model.start(model.parameters(core[:, 0]))
    cores = model.path(start, core.shape[1] - 1)
    apart = np.abs(model.difference(core, cores))
    known = sigma > 0.0
    off = np.where(known, apart / np.where(known, sigma, 1.0), 0.0)
    return np.asarray(off.max((1, 2)), dtype=np.float64)


def _checked(found: Estimates, tests: Sequence[SelfTest]) -> Estimates:
    """Estimates of a bound without the runs for which there is none, each with what it says."""
    verdict = judged(tests, len(found.status))
    lost = verdict.code == Verdict.LOST
    for values in (found.state, found.sigma, found.covariance):
        values[lost] = np.nan
    return found._replace(status=np.where(verdict.code > 0, verdict.sentence, found.status))


def _estimates(state: Array, sigma: Array, covariance: Array, kept: list[int]) -> Estimates:
    """Estimates of a bound, which judges no innovations."""
    runs, epochs = state.shape[:2]
    return Estimates(
        *(state, sigma, covariance, np.array(kept, dtype=np.int64)),
        nis=np.full((runs, epochs), np.nan),
        nis_dof=np.zeros((runs, epochs), dtype=np.int64),
        status=np.array(["linearised at the truth"] * runs),
    )
