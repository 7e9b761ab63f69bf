"""Estimators of a motion and of landmarks: with a batch first, without, and their bound."""

from collections.abc import Iterable
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.filters.estimates import Estimates
from debrisest.filters.landmark_model import LandmarkModel, core_of, points_of, split
from debrisest.filters.landmarks.against_truth import costs
from debrisest.filters.landmarks.batch_start import Batch, Problem, batch_problem
from debrisest.filters.landmarks.gauge import information
from debrisest.filters.landmarks.growing_windows import Window
from debrisest.filters.landmarks.landmark_filter import Annealing, landmark_filter
from debrisest.filters.landmarks.self_tests import self_tests
from debrisest.filters.landmarks.update import Belief, UpdateSettings
from debrisest.filters.landmarks.whole_arc import Arc, whole_arc, window_ends
from debrisest.filters.self_test import cost_test, gauge_test
from debrisest.filters.verdict import SelfTest, told
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.roles import FilterPart, Given, NonNegative, Positive

GATE = 1e-3
"""False alarms of the gate: 13.8 for a point's two pixels."""
_FEWEST_FRAMES = 5


class _LandmarkFilter(FilterPart):
    version = 5
    takes = "landmark_model"
    iterations: Annotated[int, Field(ge=1)] = 3
    """Linearisations of a frame at most."""
    gate: bool = True
    """Reject points and ranges with a probability below 0.1 % (13.8 for two pixels)."""
    keep_s: KeptTimes = []

    def _settings(self) -> UpdateSettings:
        return UpdateSettings(iterations=self.iterations, false_alarm=GATE if self.gate else None)


class LandmarkBatch(_LandmarkFilter):
    """Least squares over windows that grow to the end, from both mirrors, and a filter between.

    The estimate of a window's end is that of all frames so far; from there to the next one the
    iterated filter carries it on. Up to the end of the first windows it is their own.
    """

    version = 6
    kind: Literal["landmark_batch"]
    windows_s: list[Positive] = [50.0, 100.0, 200.0, 350.0, 600.0]
    """Lengths of the windows."""
    spacing_s: list[Positive] = [5.0, 5.0, 5.0, 10.0, 5.0]
    """Time between the frames used in each; at least five frames a window."""
    batch_iterations: Annotated[int, Field(ge=1)] = 15
    """Linearisations in a window; three times as many in the last one."""
    restarts: Annotated[int, Field(ge=0)] = 4
    """Other first guesses to try at most."""
    mirrored: bool = True
    """Try the mirror too."""
    false_matches: bool = False
    """Cauchy's loss, which lets go of false matches."""

    @model_validator(mode="after")
    def _windows(self) -> "LandmarkBatch":
        if len(self.windows_s) != len(self.spacing_s) or not self.windows_s:
            raise ValueError("windows_s and spacing_s need as many entries, at least one")
        if sorted(self.windows_s) != self.windows_s:
            raise ValueError("windows_s must grow")
        for end, spacing in zip(self.windows_s, self.spacing_s):
            if spacing > end:
                raise ValueError(f"a spacing of {spacing:g} s exceeds its window of {end:g} s")
            if end // spacing + 1 < _FEWEST_FRAMES:
                raise ValueError(
                    f"a window of {end:g} s with a spacing of {spacing:g} s has fewer than "
                    f"{_FEWEST_FRAMES} frames"
                )
        return self

    def run(self, model: LandmarkModel, given: Given) -> Estimates:
        """Return the estimates of all epochs; up to the first windows' end they are their own."""
        observed, held = split(model, given.measured), model.held
        kept, last = kept_epochs(self.keep_s, given.clock), len(given.clock.times) - 1
        batch = self._batch(given.clock)
        task = batch_problem(
            model,
            observed,
            model.parameters(core_of(model, given.state)),
            given.covariance[:, held:, held:],
            batch,
        )
        with np.errstate(all="ignore"):
            arc = whole_arc(task, window_ends(batch.windows[-1].last, last, kept))
            tests = self_tests(task, arc)
            compared = {} if given.truth is None else _compared(task, arc, given.truth)
        first = arc.anchors[0]
        found = landmark_filter(
            model,
            first.start,
            first.present,
            np.full(len(given.measured), first.epoch),
            observed,
            self._settings(),
            keep=kept,
            anchors={anchor.epoch: (anchor.belief, anchor.present) for anchor in arc.anchors},
        )
        found = found._replace(
            counts=found.counts
            | {"restarts": arc.found.restarts, "fit": arc.found.best.found.ratio}
            | compared
        )
        return told(found, tests)

    def _batch(self, clock: Clock) -> Batch:
        return Batch(
            windows=_windows(zip(self.windows_s, self.spacing_s), clock),
            iterations=self.batch_iterations,
            restarts=self.restarts,
            robust=self.false_matches,
            mirrored=self.mirrored,
        )


class LandmarkFilter(_LandmarkFilter):
    """The iterated filter from the first frame on: free gauge, noise annealed.

    The sigmas that it tells take nothing for known about the gauge that was not known at the start.
    """

    version = 6
    kind: Literal["landmark_filter"]
    annealing: NonNegative = 100.0
    """The variance of the noise is multiplied by 1 + this at time zero."""
    annealing_s: Positive = 100.0
    """Time in which that falls by a factor e."""

    def run(self, model: LandmarkModel, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
        observed, held = split(model, given.measured), model.held
        core, by_parameters = model.start(model.parameters(core_of(model, given.state)))
        runs, n_e = given.covariance.shape[:2]
        n_c = model.errors
        covariance = np.zeros((runs, n_e, n_e))
        inner = given.covariance[:, held:n_c, held:n_c]
        covariance[:, :n_c, :n_c] = by_parameters @ inner @ np.swapaxes(by_parameters, -1, -2)
        covariance[:, :held, :held] += given.covariance[:, :held, :held]
        begun = Belief(core, np.zeros((runs, model.landmarks, 3)), covariance)
        found = landmark_filter(
            model,
            begun,
            np.zeros((runs, model.landmarks), dtype=np.bool_),
            np.full(runs, -1),
            observed,
            self._settings(),
            Annealing(self.annealing, self.annealing_s / given.clock.step),
            keep=kept_epochs(self.keep_s, given.clock),
            untold=information(model, begun),
        )
        tests = [_innovations(found)]
        if "claimed" in found.counts:
            tests.append(gauge_test(found.counts.pop("claimed")[:, -1]))
        return told(found, tests)


def _windows(ends: Iterable[tuple[float, float]], clock: Clock) -> list[Window]:
    """Windows in epochs, none longer than the experiment."""
    last = len(clock.times) - 1
    windows = [
        Window(min(round(end / clock.step), last), max(1, round(spacing / clock.step)))
        for end, spacing in ends
    ]
    return list(dict.fromkeys(windows))


def _compared(task: Problem, arc: Arc, truth: Array) -> Data:
    """Costs at the last epoch, and how many numbers they are of."""
    core, points = core_of(task.model, truth[:, 0]), points_of(task.model, truth[:, 0])
    own, true, numbers = costs(task, arc, core, points)
    result: Data = {"cost_numbers": numbers}
    for name, value in (("cost", own), ("cost_of_truth", true)):
        result[name] = np.full(truth.shape[:2], np.nan)
        result[name][:, -1] = value
    return result


def _innovations(found: Estimates) -> SelfTest:
    """Test the innovations of the second half, by which a filter notices a misfit."""
    half = found.nis.shape[1] // 2
    return cost_test(np.nansum(found.nis[:, half:], axis=1), found.nis_dof[:, half:].sum(1))
