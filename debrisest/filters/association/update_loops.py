"""An update by one sensor's points as plain loops over runs and tracks, for `debrisest.compiled`.

The formulas are those of `update`, `evidence` and `restless`, where their words are. Points have
two components, and matrices of two rows are written out.
"""

import math
from typing import Any

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.compiled import compiled


@compiled
def judge(
    innovation: Array, h: Array, covariance: Array, noise: Array, gate: float
) -> tuple[BoolArray, Array]:
    """Return which detections (row, detection, 2) are there, and squared distances.

    A row is a track of a run; ``h (row, 2, n)``, ``covariance (row, n, n)``.
    """
    rows, detections = innovation.shape[:2]
    present = np.zeros((rows, detections), dtype=np.bool_)
    distance = np.full((rows, detections), np.inf)
    cross = np.empty(h.shape[1:])
    for r in range(rows):
        if not np.isfinite(h[r]).all():
            continue
        _cross(h[r], covariance[r], 1.0, cross)
        xx, xy, yy = _inverse(_total(h[r], cross, 1.0, noise))
        for i in range(detections):
            x, y = innovation[r, i, 0], innovation[r, i, 1]
            present[r, i] = math.isfinite(x) and math.isfinite(y)
            square = xx * x * x + 2.0 * xy * x * y + yy * y * y
            if present[r, i] and square <= gate:
                distance[r, i] = square
    return present, distance


@compiled
def move(
    innovation: Array, distance: Array, probability: Array, h: Array, noise: Array,
    state: Array, covariance: Array,
) -> tuple[Array, ...]:  # fmt: skip
    """Update state (row, n) and covariance in place; return what `beside` needs of a row.

    That is the trust (row,), the combined innovation (row, 2), the S (row, 3) of an innovation that
    is certain and the spread of this one, xx, xy, yy; H (row, 2, n) of what is used, and the gain.
    """
    rows, detections = distance.shape
    trust, mean = np.zeros(rows), np.zeros((rows, 2))
    total, spread = np.empty((rows, 3)), np.empty((rows, 3))
    used, gain = np.zeros(h.shape), np.empty(h.shape)
    cross, after = np.empty(h.shape[1:]), np.empty(h.shape[1:])
    for r in range(rows):
        if np.isfinite(distance[r]).any():
            used[r] = h[r]
        for i in range(detections):
            if probability[r, i] > 0.0:
                trust[r] += probability[r, i]
                mean[r, 0] += probability[r, i] * innovation[r, i, 0]
                mean[r, 1] += probability[r, i] * innovation[r, i, 1]
        b = trust[r] = min(trust[r], 1.0)
        mean_x, mean_y = mean[r, 0], mean[r, 1]
        rest = 1.0 - b
        xx, xy, yy = rest * mean_x * mean_x, rest * mean_x * mean_y, rest * mean_y * mean_y
        for i in range(detections):
            if probability[r, i] > 0.0:
                x, y = innovation[r, i, 0] - mean_x, innovation[r, i, 1] - mean_y
                xx += probability[r, i] * x * x
                xy += probability[r, i] * x * y
                yy += probability[r, i] * y * y
        _cross(used[r], covariance[r], 1.0, cross)
        s = _total(used[r], cross, 1.0, noise)
        total[r, 0], total[r, 1], total[r, 2] = s
        spread[r, 0] = xx + b * noise[0, 0] + b * rest * (s[0] - noise[0, 0])
        spread[r, 1] = xy + b * noise[0, 1] + b * rest * (s[1] - noise[0, 1])
        spread[r, 2] = yy + b * noise[1, 1] + b * rest * (s[2] - noise[1, 1])
        _gain(s, cross, gain[r])
        for i in range(state.shape[1]):
            state[r, i] += mean_x * gain[r, 0, i] + mean_y * gain[r, 1, i]
        around = (spread[r, 0], spread[r, 1], spread[r, 2])
        _joseph(used[r], covariance[r], b, gain[r], around, cross, after)
    return trust, mean, total, spread, used, gain


@compiled
def beside(
    moved: tuple[Array, ...], doubted: Array, noise: Array, pull: Array, apart: Array, bank: Array
) -> tuple[Array, Array, Array]:
    """Update what runs beside the target in place; return score, information, likelihoods.

    ``doubted (run, 2, doubt)``, ``pull (run, n, doubt)``, and of the bank ``apart (run, filter,
    n)`` and ``bank (run, filter, n, n)``.
    """
    trust, mean, total, spread, used, gain = moved
    (runs, n, doubts), filters = pull.shape, apart.shape[1]
    score, information = np.zeros((runs, doubts)), np.zeros((runs, doubts, doubts))
    likelihood = np.empty((runs, filters))
    change, better = np.empty((2, doubts)), np.empty((2, n))
    cross, after = np.empty((2, n)), np.empty((2, n))
    for r in range(runs):
        b, shown, h, k = trust[r], mean[r], used[r], gain[r]
        inverse = _inverse((total[r, 0], total[r, 1], total[r, 2]))
        _pull(pull[r], doubted[r], h, b, k, change)
        _score(change, inverse, b, shown, score[r], information[r])
        unseen = 0.0 if b > 0.0 else 1.0
        around = (
            spread[r, 0] + unseen * noise[0, 0],
            spread[r, 1] + unseen * noise[0, 1],
            spread[r, 2] + unseen * noise[1, 1],
        )
        for f in range(filters):
            _cross(h, bank[r, f], b, cross)
            s = _own(h, cross, b)
            s = (s[0] + around[0], s[1] + around[1], s[2] + around[2])
            _gain(s, cross, better)
            likelihood[r, f] = _apart(apart[r, f], h, b, shown, s, better, k)
            _joseph(h, bank[r, f], b, better, around, cross, after)
    return score, information, likelihood


@compiled
def _pull(pull: Array, doubted: Array, h: Array, b: float, gain: Array, change: Array) -> None:
    """Write what is shown per doubt, ``change (2, doubt)``, and update the pull."""
    n, doubts = pull.shape
    for j in range(doubts):
        x, y = doubted[0, j], doubted[1, j]
        for i in range(n):
            x += h[0, i] * pull[i, j]
            y += h[1, i] * pull[i, j]
        for i in range(n):
            pull[i, j] -= b * (gain[0, i] * x + gain[1, i] * y)
        change[0, j], change[1, j] = x, y


@compiled
def _score(
    change: Array, inverse: Any, b: float, shown: Array, score: Array, information: Array
) -> None:
    xx, xy, yy = inverse
    for j in range(len(score)):
        white_x = xx * change[0, j] + xy * change[1, j]
        white_y = xy * change[0, j] + yy * change[1, j]
        score[j] = white_x * shown[0] + white_y * shown[1]
        for i in range(len(score)):
            information[i, j] = b * (white_x * change[0, i] + white_y * change[1, i])


@compiled
def _apart(
    apart: Array, h: Array, b: float, shown: Array, total: Any, better: Array, gain: Array
) -> float:
    """Update a filter's state; return the logarithmic likelihood of what is shown."""
    x, y = shown[0], shown[1]
    for i in range(len(apart)):
        x -= b * h[0, i] * apart[i]
        y -= b * h[1, i] * apart[i]
    for i in range(len(apart)):
        apart[i] += x * better[0, i] + y * better[1, i]
        apart[i] -= shown[0] * gain[0, i] + shown[1] * gain[1, i]
    xx, xy, yy = _inverse(total)
    square = xx * x * x + 2.0 * xy * x * y + yy * y * y
    return float(-0.5 * (square + math.log(abs(total[0] * total[2] - total[1] * total[1]))))


@compiled
def _cross(h: Array, covariance: Array, b: float, cross: Array) -> None:
    """Write b H P (2, n)."""
    n = len(covariance)
    for a in range(2):
        for j in range(n):
            cross[a, j] = 0.0
        for i in range(n):
            factor = b * h[a, i]
            for j in range(n):
                cross[a, j] += factor * covariance[i, j]


@compiled
def _own(h: Array, cross: Array, b: float) -> Any:
    """Return the elements xx, xy, yy of b H P H^T."""
    xx = xy = yy = 0.0
    for i in range(h.shape[1]):
        xx += cross[0, i] * h[0, i]
        xy += cross[0, i] * h[1, i]
        yy += cross[1, i] * h[1, i]
    return b * xx, b * xy, b * yy


@compiled
def _total(h: Array, cross: Array, b: float, noise: Array) -> Any:
    xx, xy, yy = _own(h, cross, b)
    return xx + noise[0, 0], xy + noise[0, 1], yy + noise[1, 1]


@compiled
def _inverse(s: Any) -> Any:
    determinant = s[0] * s[2] - s[1] * s[1]
    return s[2] / determinant, -s[1] / determinant, s[0] / determinant


@compiled
def _gain(s: Any, cross: Array, gain: Array) -> None:
    xx, xy, yy = _inverse(s)
    for i in range(cross.shape[1]):
        gain[0, i] = xx * cross[0, i] + xy * cross[1, i]
        gain[1, i] = xy * cross[0, i] + yy * cross[1, i]


@compiled
def _joseph(
    h: Array, covariance: Array, b: float, gain: Array, spread: Any, cross: Array, after: Array
) -> None:
    """Replace P by (I - b K H) P (I - b K H)^T + K S K^T; ``gain`` is K^T (2, n)."""
    n = len(covariance)
    _cross(h, covariance, b, cross)
    for i in range(n):
        for j in range(n):
            covariance[i, j] -= gain[0, i] * cross[0, j] + gain[1, i] * cross[1, j]
    for i in range(n):
        after[0, i] = after[1, i] = 0.0
        for k in range(n):
            after[0, i] += b * h[0, k] * covariance[i, k]
            after[1, i] += b * h[1, k] * covariance[i, k]
        after[0, i] -= spread[0] * gain[0, i] + spread[1] * gain[1, i]
        after[1, i] -= spread[1] * gain[0, i] + spread[2] * gain[1, i]
    for i in range(n):
        for j in range(n):
            covariance[i, j] -= after[0, i] * gain[0, j] + after[1, i] * gain[1, j]
