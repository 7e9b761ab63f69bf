"""Distances of pairs, rigid sets and odd points as plain loops, for `debrisest.compiled`.

The steps are those of `rigid_sets`, where their words are.
"""

import math

import numpy as np

from debrisest.array_loops import fill
from debrisest.arrays import Array, BoolArray
from debrisest.compiled import compiled
from debrisest.order_loops import quantile


@compiled
def pairs(
    points: Array, seen: BoolArray, partners: BoolArray, given: Array, fewest: int, scale: float
) -> tuple[Array, Array, Array]:
    """Return length, noise and common epochs (feature, feature) of pairs that are partners.

    ``points (time, feature, 3)``, ``seen (time, feature)``; ``given (feature, feature)`` are the
    lengths of a known body, or nothing (0, 0).
    """
    times, features = seen.shape
    length, noise = np.full((features, features), np.nan), np.full((features, features), np.nan)
    common, far = np.zeros((features, features)), np.empty(times)
    for i in range(features):
        for j in range(i + 1, features):
            count = 0
            for t in range(times if partners[i, j] else 0):
                if seen[t, i] and seen[t, j]:
                    far[count] = _distance(points[t], i, j)
                    count += 1
            common[i, j] = common[j, i] = count
            if count >= fewest:
                middle = given[i, j] if len(given) else quantile(far[:count], 0.5)
                for t in range(count):
                    far[t] = abs(far[t] - middle)
                off = quantile(far[:count], 0.5)
                length[i, j] = length[j, i] = middle
                noise[i, j] = noise[j, i] = scale * off
    return length, noise, common


@compiled
def _distance(points: Array, i: int, j: int) -> float:
    x, y, z = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1], points[i, 2] - points[j, 2]
    return math.sqrt(x * x + y * y + z * z)


@compiled
def grown(votes: Array, seed: int, enough: float) -> BoolArray:
    """Return the set (feature,) about a point: others join, those with most agreement first."""
    features = len(votes)
    members, newest = np.zeros(features, dtype=np.bool_), seed
    asked, agreed = np.zeros(features), np.zeros(features)
    while newest >= 0:
        members[newest] = True
        best, most = -1, -1.0
        for n in range(features):
            vote = votes[n, newest]
            if not np.isnan(vote):
                asked[n] += 1.0
                agreed[n] += vote
            fits = not members[n] and asked[n] > 0.0 and agreed[n] >= enough * asked[n]
            if fits and agreed[n] > most:
                best, most = n, agreed[n]
        newest = best
    return members


@compiled
def odd_points(points: Array, seen: BoolArray, length: Array, limit: float) -> BoolArray:
    """Return points (time, feature) at odd distances from most others of their epoch.

    Of pairs without a ``length (feature, feature)`` nothing is asked.
    """
    times, features = seen.shape
    odd = np.zeros(seen.shape, dtype=np.bool_)
    asked, agreed = np.empty(features), np.empty(features)
    for t in range(times):
        for _ in range(2):
            fill(0.0, asked)
            fill(0.0, agreed)
            more = False
            for i in range(features):
                for j in range(i + 1, features):
                    both = seen[t, i] and seen[t, j] and not (odd[t, i] or odd[t, j])
                    if both and not np.isnan(length[i, j]):
                        near = abs(_distance(points[t], i, j) - length[i, j]) < limit
                        asked[i] += 1.0
                        asked[j] += 1.0
                        agreed[i] += near
                        agreed[j] += near
            for n in range(features):
                if seen[t, n] and not odd[t, n] and agreed[n] < 0.5 * asked[n]:
                    odd[t, n] = more = True
            if not more:
                break
    return odd
