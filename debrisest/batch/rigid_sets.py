"""Which tracks belong to one rigid body, by the distances of pairs; and the noise these show."""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.batch.tracks import Tracks

_TO_SIGMA = 1.4826  # from the median deviation of Gaussian noise
_RIGID_SHARE = 0.2  # of all pairs, at least so many are rigid
_FEWEST_COMMON = 4
_LOOSE, _SPREAD = 1.5, 4.0  # limit of a pair's noise, and how it widens with few epochs
_ODD = 6.0  # sigmas of a distance
_AGREED = 0.8  # of the members that a point was seen with


class Pairs(NamedTuple):
    """Distances of pairs of points, each (feature, feature)."""

    length: Array
    """Median distance, m, or that of the known body."""
    noise: Array
    """Standard deviation of one point along the line, m, robust, NaN where seldom seen together."""
    common: Array
    """Epochs in which both are seen."""


def pairs(tracks: Tracks, model: Array | None = None) -> Pairs:
    """Return how constant the distances are: about their median, or those of a known body."""
    features = tracks.weight.shape[1]
    length, noise = np.full((2, features, features), np.nan)
    common = np.zeros((features, features))
    for i in range(features):
        shows = tracks.seen[:, i]
        both = tracks.seen[shows]
        distance = np.linalg.norm(tracks.points[shows] - tracks.points[shows, i, None], axis=-1)
        common[i] = both.sum(axis=0)
        enough = (common[i] >= _FEWEST_COMMON) & (np.arange(features) != i)
        shown = np.where(both, distance, np.nan)[:, enough]
        middle = np.nanmedian(shown, axis=0)
        if model is not None:
            middle = np.linalg.norm(model - model[i], axis=-1)[enough]
        length[i, enough] = middle
        deviation = np.abs(shown - middle)
        noise[i, enough] = _TO_SIGMA / np.sqrt(2.0) * np.nanmedian(deviation, axis=0)
    return Pairs(length, noise, common)


def noise_of(found: Pairs) -> float:
    """Return the standard deviation of a point, m, NaN without pairs that are seen often."""
    shown = found.noise[np.isfinite(found.noise)]
    if not len(shown):
        return np.nan
    rigid = np.quantile(shown, _RIGID_SHARE)
    return float(np.median(shown[shown <= _LOOSE * rigid]))


def largest_rigid_set(found: Pairs, sigma: float) -> BoolArray:
    """Return which points (feature,) keep their distances; the largest such set.

    ``sigma``, m, is the noise of a point. Pairs that were seldom seen together do not vote.
    """
    limit = sigma * (_LOOSE + _SPREAD / np.sqrt(np.maximum(found.common, 1.0)))
    votes = np.where(np.isfinite(found.noise), found.noise <= limit, np.nan)
    best = np.zeros(len(votes), dtype=bool)
    for seed in np.argsort(-np.nansum(votes, axis=1)):
        members = _grown(votes, int(seed))
        if members.sum() > best.sum():
            best = members
        if best.sum() > len(votes) / 2:
            break
    return best


def odd_points(tracks: Tracks, found: Pairs, sigma: float) -> BoolArray:
    """Return observations (time, feature) at odd distances from most others of their epoch.

    So wrong matches are told before any motion is known, also two that are swapped.
    """
    odd = np.zeros(tracks.seen.shape, dtype=bool)
    for _ in range(2):
        seen = tracks.seen & ~odd
        asked, agreed = np.zeros((2, *seen.shape))
        for i in range(seen.shape[1]):
            shows = seen[:, i]
            points = tracks.points[shows]
            distance = np.linalg.norm(points - points[:, i, None], axis=-1)
            votes = seen[shows] & np.isfinite(found.length[i])
            asked[shows, i] = votes.sum(axis=1)
            close = np.abs(distance - found.length[i]) < _ODD * np.sqrt(2.0) * sigma
            agreed[shows, i] = np.sum(votes & close, axis=1)
        odd |= seen & (agreed < 0.5 * asked)
    return odd


def _grown(votes: Array, seed: int) -> BoolArray:
    """Return the set about a point: others join, those with most agreement first."""
    members = np.zeros(len(votes), dtype=bool)
    members[seed] = True
    while True:
        inside = votes[:, members]
        asked = np.isfinite(inside).sum(axis=1)
        agreed = np.nansum(inside, axis=1)
        fits = ~members & (asked > 0) & (agreed >= _AGREED * asked)
        if not fits.any():
            return members
        members[np.argmax(np.where(fits, agreed, -1.0))] = True
