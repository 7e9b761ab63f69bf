"""Estimators of a motion and of landmarks: with a batch first, without, and their bound."""

from collections.abc import Iterable
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from debrisest.clock import Clock
from debrisest.filters.estimates import Estimates
from debrisest.filters.landmark_model import LandmarkModel, core_of, split
from debrisest.filters.landmarks.batch_start import Batch, Started, StartStatus, batch_start
from debrisest.filters.landmarks.growing_windows import Window
from debrisest.filters.landmarks.landmark_filter import Annealing, landmark_filter
from debrisest.filters.landmarks.update import Belief, UpdateSettings
from debrisest.filters.status import ReplayStatus
from debrisest.outcome import sentences
from debrisest.parts.filters.kalman import KeptTimes, kept_epochs
from debrisest.roles import FilterPart, Given, NonNegative, Positive

GATE = 1e-3
"""False alarms of the gate: 13.8 for a point's two pixels."""
_FEWEST_FRAMES = 5
_EXTENDED_S = (900.0, 1200.0)
_SUSPICIOUS = 1.25
"""NIS per component in the second half beyond which a run does not fit its model."""
_SUSPECT = (
    "finished, but the innovations are larger than their covariance says: the depth may be "
    "reversed, or the model of the sensors is not that of these measurements"
)


class _LandmarkFilter(FilterPart):
    version = 2
    takes = "landmark_model"
    iterations: Annotated[int, Field(ge=1)] = 3
    gate: bool = True
    keep_s: KeptTimes = []

    def _settings(self) -> UpdateSettings:
        return UpdateSettings(iterations=self.iterations, false_alarm=GATE if self.gate else None)


class LandmarkBatch(_LandmarkFilter):
    """Least squares over growing windows, from both mirrors, then the iterated filter."""

    kind: Literal["landmark_batch"]
    windows_s: list[Positive] = [50.0, 100.0, 200.0, 350.0, 600.0]
    spacing_s: list[Positive] = [5.0, 5.0, 5.0, 10.0, 5.0]
    extended_s: list[Positive] = list(_EXTENDED_S)
    extended_spacing_s: Positive = 10.0
    batch_iterations: Annotated[int, Field(ge=1)] = 15
    restarts: Annotated[int, Field(ge=0)] = 4
    mirrored: bool = True
    false_matches: bool = False

    @model_validator(mode="before")
    @classmethod
    def _usual_extension(cls, keys: Any) -> Any:
        """Of the usual extended windows, those that are longer than the windows."""
        if isinstance(keys, dict) and keys.get("windows_s") and "extended_s" not in keys:
            last = keys["windows_s"][-1]
            return keys | {"extended_s": [end for end in _EXTENDED_S if end > last]}
        return keys

    @model_validator(mode="after")
    def _windows(self) -> "LandmarkBatch":
        if len(self.windows_s) != len(self.spacing_s) or not self.windows_s:
            raise ValueError("windows_s and spacing_s need as many entries, at least one")
        if sorted(self.windows_s) != self.windows_s:
            raise ValueError("windows_s must grow")
        ends = [self.windows_s[-1], *self.extended_s]
        if any(after <= before for before, after in pairwise(ends)):
            raise ValueError("extended_s must ascend, and exceed the last of windows_s")
        for end, spacing in [*zip(self.windows_s, self.spacing_s), *self._extensions()]:
            if spacing > end:
                raise ValueError(f"a spacing of {spacing:g} s exceeds its window of {end:g} s")
            if end // spacing + 1 < _FEWEST_FRAMES:
                raise ValueError(
                    f"a window of {end:g} s with a spacing of {spacing:g} s has fewer than "
                    f"{_FEWEST_FRAMES} frames"
                )
        return self

    def _extensions(self) -> list[tuple[float, float]]:
        return [(end, self.extended_spacing_s) for end in self.extended_s]

    def run(self, model: LandmarkModel, given: Given) -> Estimates:
        """Return the estimates of all epochs; up to the batch's end they are the batch's own."""
        observed, held = split(model, given.measured), model.held
        with np.errstate(all="ignore"):
            started = batch_start(
                model,
                observed,
                model.parameters(core_of(model, given.state)),
                given.covariance[:, held:, held:],
                self._batch(given.clock),
            )
        found = landmark_filter(
            model,
            Belief(started.core, started.points, started.covariance),
            started.present,
            started.last,
            observed,
            self._settings(),
            keep=kept_epochs(self.keep_s, given.clock),
        )
        counts = {"restarts": started.restarts, "fit": started.ratio}
        return found._replace(status=_status(found, started), counts=found.counts | counts)

    def _batch(self, clock: Clock) -> Batch:
        return Batch(
            windows=_windows(zip(self.windows_s, self.spacing_s), clock),
            extended=_windows(self._extensions(), clock),
            iterations=self.batch_iterations,
            restarts=self.restarts,
            robust=self.false_matches,
            mirrored=self.mirrored,
        )


class LandmarkFilter(_LandmarkFilter):
    """The iterated filter from the first frame on: free gauge, noise annealed."""

    kind: Literal["landmark_filter"]
    annealing: NonNegative = Field(100.0, description="noise variance times 1 + this at time zero")
    annealing_s: Positive = Field(100.0, description="time in which that falls by a factor e")

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
        found = landmark_filter(
            model,
            Belief(core, np.zeros((runs, model.landmarks, 3)), covariance),
            np.zeros((runs, model.landmarks), dtype=np.bool_),
            np.full(runs, -1),
            observed,
            self._settings(),
            Annealing(self.annealing, self.annealing_s / given.clock.step),
            keep=kept_epochs(self.keep_s, given.clock),
        )
        return found._replace(status=_status(found, None))


def _windows(ends: Iterable[tuple[float, float]], clock: Clock) -> list[Window]:
    """Windows in epochs, none longer than the experiment."""
    last = len(clock.times) - 1
    windows = [
        Window(min(round(end / clock.step), last), max(1, round(spacing / clock.step)))
        for end, spacing in ends
    ]
    return list(dict.fromkeys(windows))


def _status(found: Estimates, started: Started | None) -> NDArray[np.str_]:
    """How each run ended: the filter's trouble first, then the start's, then suspicions."""
    half = found.nis.shape[1] // 2
    dof = found.nis_dof[:, half:].sum(1)
    mean = np.nansum(found.nis[:, half:], axis=1) / np.maximum(dof, 1)
    words = np.where(mean > _SUSPICIOUS, _SUSPECT, StartStatus.FOUND.sentence)
    if started is not None:
        troubled = started.status != StartStatus.FOUND
        words = np.where(troubled, sentences(started.status, StartStatus), words)
    return np.where(found.status == ReplayStatus.CONVERGED.sentence, words, found.status)
