"""Probabilities that detections belong to several tracks, none to more than one."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.association.weights import Validation, weights

MOST_TRACKS = 8
"""Memory grows with tracks times 4^tracks."""

SMALLEST_PRODUCT = 1e-300


class _Links(NamedTuple):
    """Steps from a set of tracks to the set with one more; a set is a number, a track its bit."""

    track: IntArray
    smaller: IntArray
    larger: IntArray
    to_larger: Array
    """Sums over the links into each set, (link, set)."""
    to_smaller: Array
    """Sums over the links out of each set, (link, set)."""
    to_track: Array
    """Sums over the links of each track, (link, track)."""


def joint(distance: Array, validation: Validation, d: int) -> Array:
    """Probability of each detection to be that of each track, beta (..., track, detection).

    By squared distances of the same shape, infinite where a track did not validate a detection.
    A joint event weighs the product of the weights that its tracks have alone; events in which two
    tracks share a detection are ruled out. One track, or tracks with nothing in common, get the
    probabilities of `probabilistic`. A neighbour's detection in the gate counts as clutter in b.

    Tracks that cannot miss still have an answer where they must share a detection: absence weighs
    at least so much that the product over all tracks does not underflow.
    """
    found = weights(distance, validation, d)
    least = SMALLEST_PRODUCT ** (1.0 / distance.shape[-2])
    return exclusive(found.present, np.maximum(found.absent, least))


def exclusive(present: Array, absent: Array) -> Array:
    """Marginals (..., track, detection) of a distribution over exclusive assignments.

    An assignment gives each track one detection of its own, with weight `present` (..., track,
    detection), or none, with weight `absent` (..., track); it weighs the product. Not the
    assignments are listed but, detection after detection, the sets of tracks that have theirs
    already: a forward and a backward sum over 2^tracks sets, of positive terms only.
    """
    tracks, detections = present.shape[-2:]
    if tracks > MOST_TRACKS:
        raise ValueError(f"at most {MOST_TRACKS} tracks can be associated jointly, not {tracks}")
    links = _links(tracks)
    weight = np.swapaxes(present, -2, -1)[..., links.track]
    forward = [_nobody_yet(present.shape[:-2], tracks)]
    for i in range(detections - 1):
        forward.append(_step(forward[i], weight[..., i, :], links.smaller, links.to_larger))
    backward = [_missing(absent)]
    for i in range(detections - 1, -1, -1):
        backward.append(_step(backward[-1], weight[..., i, :], links.larger, links.to_smaller))
    total = backward[-1][..., 0]
    if detections == 0:
        return np.zeros(present.shape)
    before = np.stack(forward, axis=-2)[..., links.smaller]
    after = np.stack(backward[-2::-1], axis=-2)[..., links.larger]
    marginal = (weight * before * after) @ links.to_track
    return np.asarray(np.swapaxes(marginal, -2, -1) / total[..., None, None])


def _nobody_yet(shape: tuple[int, ...], tracks: int) -> Array:
    start = np.zeros((*shape, 2**tracks))
    start[..., 0] = 1.0
    return start


def _missing(absent: Array) -> Array:
    """Weight (..., set) of all tracks outside the set having no detection."""
    tracks = absent.shape[-1]
    outside = (np.arange(2**tracks)[:, None] >> np.arange(tracks)) & 1 == 0
    return np.asarray(np.where(outside, absent[..., None, :], 1.0).prod(-1))


def _step(sums: Array, weight: Array, origin: IntArray, target: Array) -> Array:
    """Let one detection belong to nobody, or to one of the tracks that it may belong to."""
    return np.asarray(sums + ((weight * sums[..., origin])[..., None, :] @ target)[..., 0, :])


@lru_cache
def _links(tracks: int) -> _Links:
    sets = np.arange(2**tracks)
    smaller, track = np.nonzero((sets[:, None] >> np.arange(tracks)) & 1 == 0)
    larger = smaller + (1 << track)
    return _Links(
        *(track, smaller, larger),
        to_larger=np.eye(2**tracks)[larger],
        to_smaller=np.eye(2**tracks)[smaller],
        to_track=np.eye(tracks)[track],
    )
