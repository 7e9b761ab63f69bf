"""Which tracks belong to one rigid body, by the distances of pairs; and the noise these show.

A point among many is compared with some partners only, so that the cost grows with their number.
"""

from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray
from debrisest.batch.row_median import row_median
from debrisest.batch.tracks import Tracks

_TO_SIGMA = 1.4826  # from the median deviation of Gaussian noise
_OF_A_POINT = _TO_SIGMA / np.sqrt(2.0)
_RIGID_SHARE = 0.2  # of all pairs, at least so many are rigid
_FEWEST_COMMON = 4
_LOOSE, _SPREAD = 1.5, 4.0  # limit of a pair's noise, and how it widens with few epochs
_FEWEST_OF_A_BODY = 3
_ODD = 6.0  # sigmas of a distance
_AGREED = 0.8  # of the members that a point was seen with
_MANY = 40  # points up to which all are compared with each other
_MEETINGS = 10  # of one of many with partners


class Pairs(NamedTuple):
    """Distances of pairs of points, each (feature, feature)."""

    length: Array
    """Median distance, m, or that of the known body."""
    noise: Array
    """Standard deviation of one point along the line, m, robust, NaN where not compared, or seldom
    seen together."""
    common: Array
    """Epochs in which both are seen, zero where not compared."""


def pairs(tracks: Tracks, model: Array | None = None) -> Pairs:
    """Return how constant the distances are: about their median, or those of a known body."""
    if compiled.available():
        return _pairs_compiled(tracks, model)
    seen, points = _by_feature(tracks)
    partners = np.triu(_partners(seen))
    features = len(seen)
    length, noise = np.full((2, features, features), np.nan)
    common = np.zeros((features, features))
    for i in range(features):
        together = seen[:, seen[i]][partners[i]]
        common[i, partners[i]] = together.sum(axis=-1)
        enough = common[i] >= _FEWEST_COMMON
        apart = points[enough][:, seen[i]] - points[i, seen[i]]
        distance = np.linalg.norm(apart, axis=-1)
        shown = np.where(seen[enough][:, seen[i]], distance, np.nan)
        middle = row_median(shown)
        if model is not None:
            middle = np.linalg.norm(model - model[i], axis=-1)[enough]
        length[i, enough] = middle
        noise[i, enough] = _OF_A_POINT * row_median(np.abs(shown - middle[:, None]))
    return Pairs(*(np.where(np.tri(features, dtype=bool), p.T, p) for p in (length, noise, common)))


def _pairs_compiled(tracks: Tracks, model: Array | None) -> Pairs:
    from debrisest.batch import rigid_sets_loops

    seen = tracks.seen
    given = np.zeros((0, 0))
    if model is not None:
        given = np.linalg.norm(model - model[:, None], axis=-1)
    partners = _partners(np.ascontiguousarray(seen.T))
    return Pairs(
        *rigid_sets_loops.pairs(
            tracks.points, seen, partners, given, _FEWEST_COMMON, float(_OF_A_POINT)
        )
    )


def _by_feature(tracks: Tracks) -> tuple[BoolArray, Array]:
    """Return what is seen (feature, time) and where (feature, time, 3)."""
    seen, points = tracks.seen.T, np.swapaxes(tracks.points, 0, 1)
    return np.ascontiguousarray(seen), np.ascontiguousarray(points)


def noise_of(found: Pairs) -> float:
    """Return the standard deviation of a point, m, NaN without pairs that are seen often."""
    shown = found.noise[np.isfinite(found.noise)]
    if not len(shown):
        return np.nan
    ordered, place = np.sort(shown), _RIGID_SHARE * (len(shown) - 1)
    below, above = ordered[int(place)], ordered[min(int(place) + 1, len(ordered) - 1)]
    rigid = below + (above - below) * (place - int(place))
    count = int(np.searchsorted(ordered, _LOOSE * rigid, side="right"))
    return float(0.5 * (ordered[(count - 1) // 2] + ordered[count // 2]))


def largest_rigid_set(found: Pairs, sigma: float) -> BoolArray:
    """Return which points (feature,) keep their distances; the largest such set.

    ``sigma``, m, is the noise of a point. Pairs that were seldom seen together do not vote.
    """
    limit = sigma * (_LOOSE + _SPREAD / np.sqrt(np.maximum(found.common, 1.0)))
    votes = np.where(np.isfinite(found.noise), found.noise <= limit, np.nan)
    best, tried = np.zeros((2, len(votes)), dtype=bool)
    for seed in np.argsort(-np.nansum(votes, axis=1)):
        if tried[seed]:
            continue
        members = _grown(votes, int(seed))
        tried |= members
        if members.sum() > best.sum():
            best = members
        if best.sum() > len(votes) / 2:
            break
    return best


def on_known_body(found: Pairs, sigma: float) -> BoolArray:
    """Return which points (feature,) keep the distances of the known body.

    Sets of points that were never seen together are all of the body, since its model says so.
    """
    kept = largest_rigid_set(found, sigma)
    while True:
        compared = np.isfinite(found.noise[kept]).any(axis=0)
        others = ~kept & ~compared
        more = _among(found, sigma, others) if others.any() else others
        if more.sum() < 2:
            return kept
        kept = kept | more


def other_body(found: Pairs, sigma: float, body: BoolArray) -> BoolArray:
    """Return which points (feature,) that are not of a body keep their distances: three or more."""
    members = ~body
    if members.sum() >= _FEWEST_OF_A_BODY:
        members = _among(found, sigma, members)
    return members if members.sum() >= _FEWEST_OF_A_BODY else np.zeros_like(members)


def odd_points(tracks: Tracks, found: Pairs, sigma: float) -> BoolArray:
    """Return observations (time, feature) at odd distances from most others of their epoch.

    So wrong matches are told before any motion is known, also two that are swapped.
    """
    limit = _ODD * np.sqrt(2.0) * sigma
    if compiled.available():
        from debrisest.batch import rigid_sets_loops

        return rigid_sets_loops.odd_points(tracks.points, tracks.seen, found.length, float(limit))
    shown, points = _by_feature(tracks)
    compared = np.triu(np.isfinite(found.length))
    odd = np.zeros(shown.shape, dtype=bool)
    for _ in range(2):
        seen = shown & ~odd
        asked, agreed = np.zeros((2, *seen.shape))
        for i, others in enumerate(compared):
            votes = seen[others] & seen[i]
            off = (
                np.linalg.norm(points[others] - points[i], axis=-1) - found.length[i, others, None]
            )
            near = votes & (np.abs(off) < limit)
            for total, part in ((asked, votes), (agreed, near)):
                total[i] += part.sum(axis=0)
                total[others] += part
        newly = seen & (agreed < 0.5 * asked)
        odd |= newly
        if not newly.any():
            break
    return np.asarray(odd.T)


def _among(found: Pairs, sigma: float, points: BoolArray) -> BoolArray:
    """Return the largest rigid set (feature,) of some points."""
    among = np.ix_(points, points)
    result = np.zeros(len(points), dtype=bool)
    result[points] = largest_rigid_set(Pairs(*(part[among] for part in found)), sigma)
    return result


def _grown(votes: Array, seed: int) -> BoolArray:
    """Return the set about a point: others join, those with most agreement first."""
    if compiled.available():
        from debrisest.batch import rigid_sets_loops

        return rigid_sets_loops.grown(votes, seed, _AGREED)
    members = np.zeros(len(votes), dtype=bool)
    asked, agreed = np.zeros((2, len(votes)))
    newest = seed
    while True:
        members[newest] = True
        asked += np.isfinite(votes[:, newest])
        agreed += np.nan_to_num(votes[:, newest])
        fits = ~members & (asked > 0) & (agreed >= _AGREED * asked)
        if not fits.any():
            return members
        newest = int(np.argmax(np.where(fits, agreed, -1.0)))


def _partners(seen: BoolArray) -> BoolArray:
    """Return which points are compared (feature, feature): all, or some that are seen together.

    One of many meets others by lot at epochs that are spread over those at which it is seen.
    """
    features = len(seen)
    if features <= _MANY:
        return ~np.eye(features, dtype=bool)
    partners = np.zeros((features, features), dtype=bool)
    lot = np.random.default_rng(0)
    for i in range(features):
        epochs = np.flatnonzero(seen[i])
        spread = np.linspace(0, len(epochs) - 1, _MEETINGS if len(epochs) else 0)
        for epoch in epochs[spread.astype(np.int64)]:
            partners[i, lot.choice(np.flatnonzero(seen[:, epoch]))] = True
    np.fill_diagonal(partners, False)
    return np.asarray(partners | partners.T)
