"""Iterated extended Kalman filter of a moving core and its landmarks, batched over runs.

The motion has no process noise, and a landmark that is not there has zero rows in the covariance,
so that the shapes never change and a masked landmark is exactly an absent one.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, Data, IntArray
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.landmark_model import LandmarkModel, Observations, joined
from debrisest.filters.landmarks.gauge import honest
from debrisest.filters.landmarks.tracks import Tracks, begin, inserted, judged, without
from debrisest.filters.landmarks.update import Belief, UpdateSettings, update
from debrisest.filters.runs import take
from debrisest.filters.status import ReplayStatus


class Annealing(NamedTuple):
    """Noise variance times ``1 + gain exp(-k / epochs)``: early linearisations weigh less."""

    gain: float = 0.0
    epochs: float = 1.0

    def factor(self, k: int) -> float:
        """Return the factor of epoch k."""
        return float(1.0 + self.gain * np.exp(-k / self.epochs))


def landmark_filter(
    model: LandmarkModel,
    belief: Belief,
    present: BoolArray,
    used_up: IntArray,
    observed: Observations,
    settings: UpdateSettings,
    annealing: Annealing = Annealing(),  # noqa: B008
    keep: Sequence[int] = (),
    anchors: Mapping[int, tuple[Belief, BoolArray]] = MappingProxyType({}),
    untold: Array | None = None,
) -> Estimates:
    """Filter all runs from their belief of epoch 0.

    ``present (run, N)`` are the landmarks that it holds; frames up to ``used_up (run,)`` are
    already in it, so that it is only predicted until then (-1: none). At the epochs of ``anchors``
    a better belief of all runs, and the landmarks that it holds, take the place of the filter's.
    ``untold (run, g, g)`` is all that is known along the model's gauge (`gauge.information`); what
    the filter claims beyond that is taken out of the covariance that it tells, and counted as
    ``claimed``, how many times as much.
    """
    counts: dict[str, float] = {"rejected": 0, "updates": 0}
    counts |= {} if untold is None else {"claimed": np.nan}
    start = joined(belief.core, belief.points), belief.covariance
    epochs = observed.seen.shape[1]
    writer = EstimatesWriter(
        model.error_names, *start, epochs, keep, counts, ["dropped"], ReplayStatus
    )
    tracks, going = begin(present), writer.runs
    with np.errstate(all="ignore"):
        for k in range(epochs):
            if len(going) < len(used_up):
                model, observed, used_up = model.of(going), observed.at(going), used_up[going]
                belief, tracks = take(belief, going), take(tracks, going)
            if len(going) == 0:
                break
            if k > 0:
                belief = predict(model, belief)
            shown, active = observed.at(slice(None), k), k > used_up
            belief, tracks, figures = _frame(
                model, belief, tracks, shown, k, active, settings, annealing
            )
            if k in anchors:
                better, present = anchors[k]
                belief, tracks = take(better, writer.runs), begin(present[writer.runs])
            confirmed = np.where(tracks.confirmed[..., None], belief.points, np.nan)
            told = belief.covariance
            if untold is not None:
                known = untold[writer.runs]
                told, figures["claimed"] = honest(model, belief, tracks.confirmed, known)
            going = writer.record(
                *(k, joined(belief.core, belief.points), told, figures),
                shown=joined(belief.core, confirmed),
            )
    return writer.estimates()


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
    observed: Observations,
    k: int,
    active: BoolArray,
    settings: UpdateSettings,
    annealing: Annealing,
) -> tuple[Belief, Tracks, Data]:
    """Update, then drop and insert landmarks; and what is counted."""
    seen = observed.seen & active[:, None, None]
    shown: BoolArray = np.asarray(seen.any(-1))
    usable = observed._replace(
        seen=seen & tracks.present[..., None], common_seen=observed.common_seen & active[:, None]
    )
    if not active.any():
        return belief, tracks, {}
    belief, frame = update(model, belief, usable, k, settings, annealing.factor(k))
    new = model.placeable(seen) & ~tracks.present
    before = tracks.present
    tracks = judged(tracks, shown & before, frame.accepted)
    lost = before & ~tracks.present
    if lost.any():
        belief = without(belief, lost)
    if new.any():
        belief = inserted(model, belief, observed, new, k)
        tracks = tracks._replace(present=tracks.present | new)
    return belief, tracks, frame._asdict() | {"dropped": lost.sum(-1)}
