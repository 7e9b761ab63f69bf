"""Update of tracks, and of what runs beside the target, by one or more sensors together."""

from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.filters.association.evidence import Beside, Evidence, corrected
from debrisest.filters.association.restless import Bank
from debrisest.filters.association.update import Judged, Scan, Tracks, Weigh, update

Updated = tuple[Tracks, Beside, Evidence, Judged]


class Given(NamedTuple):
    """What is predicted, and what sensors show of it."""

    tracks: Tracks
    beside: Beside
    scan: Scan
    doubted: Array
    """(run, sensor, d, doubt)."""
    noise: Array
    gate: float
    weigh: Weigh


def updated(given: Given) -> Updated:
    """Return what `update` makes of the tracks, and `corrected` of the target's company.

    A single sensor of two components has compiled loops.
    """
    if given.scan.derivative.shape[2:4] == (1, 2) and compiled.available():
        return _by_loops(given)
    tracks, made, judged = update(given.tracks, given.scan, given.noise, given.gate, given.weigh)
    return tracks, *corrected(given.beside, made, given.doubted), judged


def _by_loops(given: Given) -> Updated:
    from debrisest.filters.association import update_loops

    tracks, noise = given.tracks, given.noise
    each = tracks.state.shape[:2]
    state, covariance = (part.reshape(-1, *part.shape[2:]).copy() for part in tracks)
    innovation, h = (part.reshape(-1, *part.shape[3:]) for part in given.scan)
    present, distance = update_loops.judge(innovation, h, covariance, noise, given.gate)
    distances = distance.reshape(*each, 1, -1)
    probability = given.weigh(distances)
    flat = probability.reshape(distance.shape)
    moved = update_loops.move(innovation, distance, flat, h, noise, state, covariance)
    target = tuple(part[:: each[1]] for part in moved)
    pull, (apart, bank) = given.beside.pull.copy(), (part.copy() for part in given.beside.bank)
    score, information, likelihood = update_loops.beside(
        target, given.doubted[:, 0], noise, pull, apart, bank
    )
    return (
        Tracks(state.reshape(tracks.state.shape), covariance.reshape(tracks.covariance.shape)),
        Beside(pull, Bank(apart, bank)),
        Evidence(score, 0.0 * information, information, likelihood),
        Judged(present.reshape(distances.shape), np.isfinite(distances), distances, probability),
    )
