"""Iterated extended Kalman filter of a moving core and its landmarks, batched over runs.

The motion has no process noise, and a landmark that is not there has zero rows in the covariance,
so that the shapes never change and a masked landmark is exactly an absent one.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import BoolArray, IntArray
from debrisest.filters.landmarks.landmark_model import LandmarkModel, Sights, joined
from debrisest.filters.landmarks.tracks import Tracks, begin, inserted, judged, without
from debrisest.filters.landmarks.update import Belief, Frame, Rule, update
from debrisest.filters.replay.estimates import Estimates, ReplayStatus, empty, finite, write
from debrisest.filters.replay.evidence import take


class Annealing(NamedTuple):
    """Noise variance times ``1 + gain exp(-k / epochs)``: early linearisations weigh less."""

    gain: float = 0.0
    epochs: float = 1.0

    def factor(self, k: int) -> float:
        """Return the factor of epoch k."""
        return float(1.0 + self.gain * np.exp(-k / self.epochs))


class Landmarked(NamedTuple):
    """Estimates of every epoch, and what became of the landmarks."""

    estimates: Estimates
    """NaN for landmarks that are not confirmed."""
    dropped: IntArray
    """How often a landmark of the run was dropped, (run,)."""
    iterations: IntArray
    """(run, time)."""


def landmark_filter(
    model: LandmarkModel,
    belief: Belief,
    present: BoolArray,
    used_up: IntArray,
    sights: Sights,
    rule: Rule,
    annealing: Annealing = Annealing(),  # noqa: B008
    keep: Sequence[int] = (),
) -> Landmarked:
    """Filter all runs from their belief of epoch 0.

    ``present (run, N)`` are the landmarks that it holds; frames up to ``used_up (run,)`` are
    already in it, so that it is only predicted until then (-1: none).
    """
    runs, epochs = sights.seen.shape[:2]
    result = empty(
        (runs, epochs, belief.core.shape[-1] + 3 * model.landmarks), len(model.error_names), keep
    )
    outcome = Landmarked(
        result, np.zeros(runs, dtype=np.int64), np.zeros((runs, epochs), dtype=np.int64)
    )
    with np.errstate(all="ignore"):
        _run(model, belief, begin(present), used_up, sights, rule, annealing, outcome)
    return outcome


def _run(
    model: LandmarkModel,
    belief: Belief,
    tracks: Tracks,
    used_up: IntArray,
    sights: Sights,
    rule: Rule,
    annealing: Annealing,
    outcome: Landmarked,
) -> None:
    result = outcome.estimates
    runs = np.arange(len(used_up))
    sound = finite(belief.core, belief.covariance)
    result.diverged_at[sound], result.status[sound] = -1, ReplayStatus.CONVERGED
    epochs = result.state.shape[1]
    for k in range(epochs):
        if not sound.all():
            _mark_lost(result, runs[~sound], k)
            alive = np.flatnonzero(sound)
            runs, model, sights = runs[alive], model.of(alive), sights.at(alive)
            belief, tracks, used_up = take(belief, alive), take(tracks, alive), used_up[alive]
            if len(runs) == 0:
                return
        if k > 0:
            belief = predict(model, belief)
        belief, tracks, frame = _frame(
            model, belief, tracks, sights.at(slice(None), k), k, k > used_up, rule, annealing
        )
        sound = finite(belief.core, belief.covariance)
        _record(outcome, runs, k, belief, tracks, frame)
    _mark_lost(result, runs[~sound], epochs)


def _mark_lost(result: Estimates, lost: IntArray, k: int) -> None:
    """Note runs that were not sound any more before epoch k."""
    result.status[lost] = ReplayStatus.DIVERGED if k > 0 else ReplayStatus.NO_START
    result.diverged_at[lost] = at = max(k - 1, 0)
    result.state[lost, at] = result.sigma[lost, at] = np.nan
    result.covariance[lost[:, None], np.flatnonzero(result.kept == at)] = np.nan


def predict(model: LandmarkModel, belief: Belief) -> Belief:
    """Belief one epoch later."""
    core, transition = model.process(belief.core)
    covariance, n_c = belief.covariance.copy(), model.errors
    covariance[:, :n_c] = transition @ covariance[:, :n_c]
    covariance[:, :, :n_c] = covariance[:, :, :n_c] @ np.swapaxes(transition, -1, -2)
    return Belief(core, belief.points, covariance)


def _frame(
    model: LandmarkModel,
    belief: Belief,
    tracks: Tracks,
    sights: Sights,
    k: int,
    active: BoolArray,
    rule: Rule,
    annealing: Annealing,
) -> tuple[Belief, Tracks, Frame | None]:
    """Update, then drop and insert landmarks."""
    seen = sights.seen & active[:, None, None]
    shown: BoolArray = np.asarray(seen.any(-1))
    usable = sights._replace(
        seen=seen & tracks.present[..., None], common_seen=sights.common_seen & active[:, None]
    )
    if not active.any():
        return belief, tracks, None
    belief, frame = update(model, belief, usable, k, rule, annealing.factor(k))
    new = model.placeable(seen) & ~tracks.present
    before = tracks.present
    tracks = judged(tracks, shown & before, frame.accepted)
    lost = before & ~tracks.present
    if lost.any():
        belief = without(belief, lost)
    if new.any():
        belief = inserted(model, belief, sights, new, k)
        tracks = tracks._replace(present=tracks.present | new)
    return belief, tracks, frame


def _record(
    outcome: Landmarked, runs: IntArray, k: int, belief: Belief, tracks: Tracks, frame: Frame | None
) -> None:
    result = outcome.estimates
    counts = tracks.confirmed[..., None]
    points = np.where(counts, belief.points, np.nan)
    write(result, k, runs, joined(belief.core, points), belief.covariance)
    outcome.dropped[runs] = tracks.dropped.sum(-1)
    if frame is not None:
        result.nis[runs, k], result.nis_dof[runs, k] = frame.nis, frame.dof
        result.rejected[runs, k] = frame.rejected
        outcome.iterations[runs, k] = frame.iterations
