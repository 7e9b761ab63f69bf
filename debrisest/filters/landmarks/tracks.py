"""Which landmarks there are: inserted, on trial, confirmed, dropped.

A landmark is inserted where it is seen and not there yet, and takes part in updates from the next
frame on. It is on trial until `CONFIRMING` frames have passed the gate; one that the gate rejects
on trial is dropped at once and inserted anew at its next sighting, so that a false match does not
become a landmark. A confirmed one is dropped after `PATIENCE` rejections in a row.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.filters.landmark_model import LandmarkModel, Observations
from debrisest.filters.landmarks.update import Belief

CONFIRMING, PATIENCE = 5, 6


class Tracks(NamedTuple):
    """Bookkeeping of landmarks, (run, N) each."""

    present: BoolArray
    hits: IntArray
    """Frames that passed the gate since the insertion."""
    misses: IntArray
    """Rejections in a row."""

    @property
    def confirmed(self) -> BoolArray:
        """Landmarks that count."""
        return np.asarray(self.present & (self.hits >= CONFIRMING))


def begin(present: BoolArray) -> Tracks:
    """Tracks of landmarks that a batch has confirmed, or of none."""
    none = np.zeros(present.shape, dtype=np.int64)
    return Tracks(present.copy(), CONFIRMING * present, none)


def judged(tracks: Tracks, shown: BoolArray, accepted: BoolArray) -> Tracks:
    """Tracks after a frame in which landmarks that are present were shown, some accepted."""
    rejected = shown & ~accepted
    hits = tracks.hits + accepted
    misses = np.where(shown, (tracks.misses + 1) * rejected, tracks.misses)
    lost = rejected & ((hits < CONFIRMING) | (misses >= PATIENCE))
    return Tracks(tracks.present & ~lost, np.where(lost, 0, hits), np.where(lost, 0, misses))


def without(belief: Belief, lost: BoolArray) -> Belief:
    """Belief without some landmarks (run, N); their rows of the covariance become zero."""
    kept = _kept(belief, lost)
    covariance = belief.covariance * kept[..., :, None] * kept[..., None, :]
    return belief._replace(covariance=covariance)


def inserted(
    model: LandmarkModel, belief: Belief, observed: Observations, new: BoolArray, k: int
) -> Belief:
    """Belief with new landmarks (run, N), their errors correlated with the core's.

    With J the derivative of their places by the core's errors and C the covariance that does not
    come from these, the joint covariance is ``T P T^T + C``, where T has J in the new rows.
    """
    runs, n_c = len(new), model.errors
    cores = np.broadcast_to(belief.core[:, None], (*new.shape, belief.core.shape[-1]))
    points, by_core, own = model.place(cores, observed.shown, np.full(new.shape, k))
    extend = np.zeros_like(belief.covariance)
    index = np.arange(extend.shape[-1])
    extend[:, index, index] = _kept(belief, new)
    rows = np.where(new[..., None, None], by_core, 0.0).reshape(runs, -1, n_c)
    extend[:, n_c:, :n_c] = rows
    covariance = extend @ belief.covariance @ np.swapaxes(extend, -1, -2)
    block = n_c + np.arange(3 * new.shape[1]).reshape(-1, 3)
    covariance[:, block[:, :, None], block[:, None, :]] += np.where(new[..., None, None], own, 0.0)
    return Belief(belief.core, np.where(new[..., None], points, belief.points), covariance)


def _kept(belief: Belief, lost: BoolArray) -> Array:
    """One for every error, zero for those of some landmarks, (run, n_e)."""
    n_c = belief.covariance.shape[-1] - 3 * lost.shape[1]
    core = np.ones((len(lost), n_c))
    return np.concatenate([core, np.repeat(~lost, 3, axis=-1)], axis=-1)
