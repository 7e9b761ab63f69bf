"""Prediction and update of the association filters as plain loops, for `debrisest.compiled`.

The formulas are those of `recursion`, `update`, `evidence`, `restless` and `companions`, where
their words are. Points have two components, and sensors update one after the other. What is
recursive is held in blocks of runs, (block, ..., run of the block), as `lane_loops` wants it; what
comes from the model and goes into estimates has the run first.
"""

import math

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.filters.association.companions import CLAIMED, NEAR
from debrisest.filters.association.lane_loops import (
    advanced,
    corrected,
    inverted,
    multiplied,
    predicted,
    scaled,
    shown,
)
from debrisest.filters.association.restless import FACTORS
from debrisest.filters.association.weight_loops import mistaken, weigh

Recursive = tuple[Array, Array, Array, Array, Array]
"""State (track, n) and covariance (track, n, n), pull (n, doubt), and of the bank the states apart
(n, filter) and covariances (filter, n, n), all with the axes of blocks around."""
Sums = tuple[Array, Array, Array, Array]
"""As `Evidence`, with the axes of blocks around."""
Predicted = tuple[Array, Array, Array, Array]
"""Nominal states (run, track, n), their points (run, track, sensor, 2), the derivatives of these
(..., 2, n), and those of the target's by the doubts (run, sensor, 2, doubt)."""
Fixed = tuple[Array, float, int, float]
"""Noise of a point (2, 2), gate, how to weigh, and the weight of absence."""


@compiled
def predict(
    moved: Array, transition: Array, nominal: Array, noise: Array, recursive: Recursive
) -> None:
    """Take everything to the next epoch, in place.

    ``nominal (run, track, n)`` move to ``moved`` with the derivative ``transition (..., n, n)``.
    """
    states, covariances, pulls, aparts, banks = recursive
    blocks, tracks, n, lanes = states.shape
    by, whole = np.empty((n, n, lanes)), np.empty((n, n, lanes))
    lag, columns = np.empty((n, 1, lanes)), np.empty((n, max(pulls.shape[2], 2), lanes))
    for block in range(blocks):
        for t in range(tracks - 1, -1, -1):
            for r in range(lanes):
                run = min(block * lanes + r, len(moved) - 1)
                for i in range(n):
                    lag[i, 0, r] = states[block, t, i, r] - nominal[run, t, i]
                    for j in range(n):
                        by[i, j, r] = transition[run, t, i, j]
            advanced(by, lag, columns)
            for r in range(lanes):
                run = min(block * lanes + r, len(moved) - 1)
                for i in range(n):
                    states[block, t, i, r] = moved[run, t, i] + lag[i, 0, r]
            predicted(by, noise, 1.0, covariances[block, t], whole)
        advanced(by, pulls[block], columns)
        advanced(by, aparts[block], columns)
        for f in range(len(FACTORS)):
            predicted(by, noise, FACTORS[f] ** 2, banks[block, f], whole)


@compiled
def look(
    scan: Array,
    before: Array,
    given: Predicted,
    fixed: Fixed,
    recursive: Recursive,
    sums: Sums,
    told: tuple[Array, Array, Array],
) -> None:
    """Update by the detections of an epoch ``scan (run, sensor, detection, 2)``, in place.

    ``before`` is what was beside the target at the last epoch, which is replaced. Told are states
    (run, track, n), the target's covariance (run, n, n) and the figures (9, run) of `by_loops`.
    """
    (noise, gate, way, absence), (state, covariance) = fixed, recursive[:2]
    (sensors, detections), (blocks, tracks, n, lanes) = scan.shape[1:3], state.shape
    shape = tracks, 2, n, lanes
    h, cross, gain = np.empty(shape), np.empty(shape), np.empty(shape)
    innovation = np.empty((tracks, detections, 2, lanes))
    distance = np.empty((tracks, detections, lanes))
    probability = np.empty((tracks, detections, lanes))
    total, moments = np.empty((tracks, 3, lanes)), np.empty((tracks, 6, lanes))
    scratch = np.empty((2 * detections + 2, 2**tracks))
    told[2][:] = 0.0
    for block in range(blocks):
        first, score = block * lanes, np.zeros((recursive[2].shape[2], lanes))
        for s in range(sensors):
            _expect(first, s, scan, given, state[block], h, innovation)
            for t in range(tracks):
                _judge(
                    *(innovation[t], h[t], noise, gate, covariance[block, t]),
                    *(cross[t], total[t], distance[t]),
                )
            weigh(way, absence, distance, probability, scratch)
            _count(first, s, noise, innovation, distance, probability, before, told[2])
            for t in range(tracks):
                _moments(innovation[t], probability[t], total[t], noise, moments[t])
                _move(
                    *(cross[t], total[t], moments[t], noise),
                    *(gain[t], state[block, t], covariance[block, t]),
                )
            made = h[0], gain[0], total[0], moments[0], noise
            _tell(block, s, made, given[3], recursive, sums, score)
        _tell_squares(block, score, sums)
        _write(first, state[block], covariance[block, 0], told)


@compiled
def _expect(
    first: int, s: int, scan: Array, given: Predicted, state: Array, h: Array, innovation: Array
) -> None:
    """Write H (track, 2, n, run) and innovations (track, detection, 2, run) of a sensor."""
    nominal, points, derivative, _ = given
    tracks, n, lanes = state.shape
    for t in range(tracks):
        for r in range(lanes):
            run = min(first + r, len(nominal) - 1)
            by = derivative[run, t, s]
            usable = True
            for a in range(2):
                for i in range(n):
                    usable = usable and math.isfinite(by[a, i])
            for a in range(2):
                expected = points[run, t, s, a] if usable else np.nan
                for i in range(n):
                    h[t, a, i, r] = by[a, i] if usable else 0.0
                    expected += h[t, a, i, r] * (state[t, i, r] - nominal[run, t, i])
                for i in range(scan.shape[2]):
                    innovation[t, i, a, r] = scan[run, s, i, a] - expected


@compiled
def _judge(
    innovation: Array,
    h: Array,
    noise: Array,
    gate: float,
    covariance: Array,
    cross: Array,
    total: Array,
    distance: Array,
) -> None:
    """Write H P, S and squared distances (detection, run), infinite outside the gate."""
    detections, lanes = distance.shape
    shown(h, covariance, np.ones(lanes), cross, total)
    inverse = np.empty((3, lanes))
    for r in range(lanes):
        total[0, r] += noise[0, 0]
        total[1, r] += noise[0, 1]
        total[2, r] += noise[1, 1]
    inverted(total, inverse)
    for i in range(detections):
        for r in range(lanes):
            x, y = innovation[i, 0, r], innovation[i, 1, r]
            square = inverse[0, r] * x * x + 2.0 * inverse[1, r] * x * y + inverse[2, r] * y * y
            distance[i, r] = square if square <= gate else np.inf


@compiled
def _count(
    first: int,
    s: int,
    noise: Array,
    innovation: Array,
    distance: Array,
    probability: Array,
    before: Array,
    figures: Array,
) -> None:
    """Add to the figures what the target's track makes of a sensor's detections."""
    now = np.empty((innovation.shape[1], 2))
    for r in range(min(distance.shape[2], len(before) - first)):
        run, detected, weighed, valid, present = first + r, 0.0, 0.0, 0, 0
        for i in range(len(now)):
            x, y = innovation[0, i, 0, r], innovation[0, i, 1, r]
            present += math.isfinite(x) and math.isfinite(y)
            if distance[0, i, r] < np.inf:
                valid += 1
                detected += probability[0, i, r]
                weighed += probability[0, i, r] * distance[0, i, r]
            claimed = False
            for t in range(len(probability)):
                claimed = claimed or probability[t, i, r] > CLAIMED
            now[i, 0], now[i, 1] = (np.nan, np.nan) if claimed else (x, y)
        if detected > 0.0:
            figures[0, run] += weighed / detected
            figures[1, run] += 2.0
        figures[2, run] += 2.0 * (present - valid)
        figures[3, run] += valid
        figures[4, run] += present > 0
        figures[5, run] += valid > 0
        figures[6, run] += mistaken(distance[0, :, r])
        near, ring = _pairs(before[run, s], now, noise)
        figures[7, run] += near
        figures[8, run] += ring
        for i in range(len(now)):
            before[run, s, i, 0], before[run, s, i, 1] = now[i, 0], now[i, 1]


@compiled
def _pairs(before: Array, now: Array, noise: Array) -> tuple[int, int]:
    """Count the pairs of detections (detection, 2) that are near, and those in a ring."""
    near = ring = 0
    determinant = 2.0 * (noise[0, 0] * noise[1, 1] - noise[0, 1] * noise[0, 1])
    xx, xy, yy = noise[1, 1] / determinant, -noise[0, 1] / determinant, noise[0, 0] / determinant
    for i in range(len(now)):
        for j in range(len(before)):
            x, y = now[i, 0] - before[j, 0], now[i, 1] - before[j, 1]
            square = x * (x * xx + y * xy) + y * (x * xy + y * yy)
            near += square < NEAR
            ring += square >= NEAR and square < 2.0 * NEAR
    return near, ring


@compiled
def _moments(
    innovation: Array, probability: Array, total: Array, noise: Array, moments: Array
) -> None:
    """Write trust, combined innovation x, y and its spread xx, xy, yy (6, run)."""
    moments[:] = 0.0
    trust, mean_x, mean_y, xx, xy, yy = moments
    lanes = len(trust)
    for i in range(len(probability)):
        for r in range(lanes):
            p, seen = probability[i, r], probability[i, r] > 0.0
            trust[r] += p
            mean_x[r] += p * (innovation[i, 0, r] if seen else 0.0)
            mean_y[r] += p * (innovation[i, 1, r] if seen else 0.0)
    for i in range(len(probability)):
        for r in range(lanes):
            p, seen = probability[i, r], probability[i, r] > 0.0
            x = (innovation[i, 0, r] if seen else 0.0) - mean_x[r]
            y = (innovation[i, 1, r] if seen else 0.0) - mean_y[r]
            xx[r] += p * x * x
            xy[r] += p * x * y
            yy[r] += p * y * y
    for r in range(lanes):
        b = trust[r] = min(trust[r], 1.0)
        rest = 1.0 - b
        x, y = mean_x[r], mean_y[r]
        xx[r] += rest * x * x + b * (noise[0, 0] + rest * (total[0, r] - noise[0, 0]))
        xy[r] += rest * x * y + b * (noise[0, 1] + rest * (total[1, r] - noise[0, 1]))
        yy[r] += rest * y * y + b * (noise[1, 1] + rest * (total[2, r] - noise[1, 1]))


@compiled
def _move(
    cross: Array,
    total: Array,
    moments: Array,
    noise: Array,
    gain: Array,
    state: Array,
    covariance: Array,
) -> None:
    """Write the gain K^T (2, n, run), and update a track; ``cross`` becomes b H P."""
    (n, lanes), around = state.shape, np.empty((3, total.shape[1]))
    inverted(total, around)
    scaled(around, cross, gain)
    for i in range(n):
        for r in range(lanes):
            state[i, r] += moments[1, r] * gain[0, i, r] + moments[2, r] * gain[1, i, r]
            cross[0, i, r] *= moments[0, r]
            cross[1, i, r] *= moments[0, r]
    for r in range(lanes):
        square = moments[0, r] * moments[0, r]
        around[0, r] = square * (total[0, r] - noise[0, 0]) + moments[3, r]
        around[1, r] = square * (total[1, r] - noise[0, 1]) + moments[4, r]
        around[2, r] = square * (total[2, r] - noise[1, 1]) + moments[5, r]
    corrected(gain, cross, around, covariance, np.empty((2, n, lanes)))


@compiled
def _tell(
    block: int,
    s: int,
    made: tuple[Array, Array, Array, Array, Array],
    doubted: Array,
    recursive: Recursive,
    sums: Sums,
    score: Array,
) -> None:
    """Update what runs beside the target, and add to the score of the epoch and to the sums."""
    h, gain, total, moments, _ = made
    pull, (n, lanes) = recursive[2][block], h.shape[1:]
    doubts, first = pull.shape[1], block * lanes
    change, white = np.empty((2, doubts, lanes)), np.empty((2, doubts, lanes))
    inverse = np.empty((3, lanes))
    multiplied(h, pull, change)
    for r in range(lanes):
        run = min(first + r, len(doubted) - 1)
        for j in range(doubts):
            change[0, j, r] += doubted[run, s, 0, j]
            change[1, j, r] += doubted[run, s, 1, j]
    inverted(total, inverse)
    scaled(inverse, change, white)
    for j in range(doubts):
        for r in range(lanes):
            score[j, r] += white[0, j, r] * moments[1, r] + white[1, j, r] * moments[2, r]
        for i in range(doubts):
            for r in range(lanes):
                product = white[0, j, r] * change[0, i, r] + white[1, j, r] * change[1, i, r]
                sums[2][block, j, i, r] += moments[0, r] * product
        for i in range(n):
            for r in range(lanes):
                moved = gain[0, i, r] * change[0, j, r] + gain[1, i, r] * change[1, j, r]
                pull[i, j, r] -= moments[0, r] * moved
    for f in range(len(FACTORS)):
        _tell_restless(made, f, recursive[3][block], recursive[4][block, f], sums[3][block, f])


@compiled
def _tell_restless(
    made: tuple[Array, Array, Array, Array, Array],
    f: int,
    apart: Array,
    covariance: Array,
    likelihood: Array,
) -> None:
    """Update a filter of the bank, and add to its logarithmic likelihood (run,)."""
    h, track_gain, _, moments, noise = made
    n, _, lanes = apart.shape
    cross, gain = np.empty((2, n, lanes)), np.empty((2, n, lanes))
    total, inverse = np.empty((3, lanes)), np.empty((3, lanes))
    shown(h, covariance, moments[0], cross, total)
    for r in range(lanes):
        unseen = 0.0 if moments[0, r] > 0.0 else 1.0
        total[0, r] += moments[3, r] + unseen * noise[0, 0]
        total[1, r] += moments[4, r] + unseen * noise[0, 1]
        total[2, r] += moments[5, r] + unseen * noise[1, 1]
    inverted(total, inverse)
    scaled(inverse, cross, gain)
    x, y = np.empty(lanes), np.empty(lanes)
    for r in range(lanes):
        x[r], y[r] = moments[1, r], moments[2, r]
    for i in range(n):
        for r in range(lanes):
            x[r] -= moments[0, r] * h[0, i, r] * apart[i, f, r]
            y[r] -= moments[0, r] * h[1, i, r] * apart[i, f, r]
    for i in range(n):
        for r in range(lanes):
            apart[i, f, r] += x[r] * gain[0, i, r] + y[r] * gain[1, i, r]
            apart[i, f, r] -= (
                moments[1, r] * track_gain[0, i, r] + moments[2, r] * track_gain[1, i, r]
            )
    for r in range(lanes):
        square = inverse[0, r] * x[r] ** 2 + 2.0 * inverse[1, r] * x[r] * y[r]
        square += inverse[2, r] * y[r] ** 2
        determinant = total[0, r] * total[2, r] - total[1, r] * total[1, r]
        likelihood[r] -= 0.5 * (square + math.log(abs(determinant)))
    corrected(gain, cross, total, covariance, np.empty((2, n, lanes)))


@compiled
def _tell_squares(block: int, score: Array, sums: Sums) -> None:
    """Add the score (doubt, run) of an epoch, and its products."""
    doubts, lanes = score.shape
    for j in range(doubts):
        for r in range(lanes):
            sums[0][block, j, r] += score[j, r]
        for i in range(doubts):
            for r in range(lanes):
                sums[1][block, j, i, r] += score[j, r] * score[i, r]


@compiled
def _write(first: int, state: Array, covariance: Array, told: tuple[Array, Array, Array]) -> None:
    """Write the states of the tracks and the target's covariance, the run first."""
    tracks, n, lanes = state.shape
    for r in range(min(lanes, len(told[0]) - first)):
        for i in range(n):
            for t in range(tracks):
                told[0][first + r, t, i] = state[t, i, r]
            for j in range(n):
                told[1][first + r, i, j] = covariance[i, j, r]
