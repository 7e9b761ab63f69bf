"""Probabilities of the detections of one sensor, of one run at a time, for compiled loops."""

import math

import numpy as np

from debrisest.arrays import Array
from debrisest.compiled import compiled
from debrisest.filters.association.joint import SMALLEST_PRODUCT

NEAREST, PROBABILISTIC, JOINT = 0, 1, 2
"""Ways to weigh."""


@compiled
def weigh(way: int, absence: float, distance: Array, probability: Array, scratch: Array) -> None:
    """Write probabilities of squared distances (track, detection, run), infinite if not validated.

    The formulas are those of `weights` and `joint`; ``absence`` is the weight of absence for one
    validated detection, ``scratch (2 detection + 2, 2^track)``.
    """
    tracks, detections, runs = distance.shape
    for r in range(runs):
        if way == JOINT:
            _exclusive(absence, distance[:, :, r], probability[:, :, r], scratch)
            continue
        for t in range(tracks):
            least, first, count = _nearest(distance[t, :, r])
            for i in range(detections):
                probability[t, i, r] = 0.0
            if way == NEAREST and count > 0:
                probability[t, first, r] = 1.0
            elif count > 0:
                log_absent = math.log(count * absence)
                largest = max(-0.5 * least, log_absent)
                total = math.exp(log_absent - largest)
                for i in range(detections):
                    weight = math.exp(-0.5 * distance[t, i, r] - largest)
                    probability[t, i, r] = weight
                    total += weight
                for i in range(detections):
                    probability[t, i, r] /= total


@compiled
def mistaken(distance: Array) -> float:
    """Return the probability that of squared distances (detection,) the least is another's."""
    least, _, count = _nearest(distance)
    total = 0.0
    for i in range(len(distance)):
        if distance[i] < np.inf:
            total += math.exp(0.5 * (least - distance[i]))
    return 1.0 - 1.0 / total if count > 0 else 0.0


@compiled
def _nearest(distance: Array) -> tuple[float, int, int]:
    """Return the least distance, which one that is, and how many are validated."""
    least, first, count = np.inf, 0, 0
    for i in range(len(distance)):
        if distance[i] < np.inf:
            count += 1
            if distance[i] < least:
                least, first = distance[i], i
    return least, first, count


@compiled
def _exclusive(absence: float, distance: Array, probability: Array, sums: Array) -> None:
    """Write marginals (track, detection) over assignments in which no two share a detection."""
    tracks, detections = distance.shape
    forward, backward = sums[: detections + 1], sums[detections + 1 :]
    for t in range(tracks):
        least, _, count = _nearest(distance[t])
        log_absent = math.log(count * absence) if count > 0 else 0.0
        largest = max(-0.5 * least, log_absent)
        absent = max(math.exp(log_absent - largest), SMALLEST_PRODUCT ** (1.0 / tracks))
        for i in range(detections):
            probability[t, i] = math.exp(-0.5 * distance[t, i] - largest)
        for e in range(1 << tracks):
            alone = 1.0 if t == 0 else backward[detections, e]
            backward[detections, e] = alone if (e >> t) & 1 else alone * absent
    forward[0] = 0.0
    forward[0, 0] = 1.0
    for i in range(detections):
        for e in range(1 << tracks):
            forward[i + 1, e] = forward[i, e]
            for t in range(tracks):
                if (e >> t) & 1:
                    forward[i + 1, e] += probability[t, i] * forward[i, e - (1 << t)]
    for i in range(detections - 1, -1, -1):
        for e in range(1 << tracks):
            backward[i, e] = backward[i + 1, e]
            for t in range(tracks):
                if not (e >> t) & 1:
                    backward[i, e] += probability[t, i] * backward[i + 1, e + (1 << t)]
    for t in range(tracks):
        for i in range(detections):
            total = 0.0
            for e in range(1 << tracks):
                if not (e >> t) & 1:
                    total += forward[i, e] * backward[i + 1, e + (1 << t)]
            probability[t, i] *= total / backward[0, 0]
