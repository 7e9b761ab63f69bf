"""Update of tracks, and of what runs beside the target, by one or more sensors together."""

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array
from debrisest.filters.association.evidence import Beside, Evidence, corrected
from debrisest.filters.association.restless import Bank
from debrisest.filters.association.update import Judged, Scan, Tracks, Weigh, update


def updated(
    tracks: Tracks,
    beside: Beside,
    scan: Scan,
    doubted: Array,
    noise: Array,
    gate: float,
    weigh: Weigh,
) -> tuple[Tracks, Beside, Evidence, Judged]:
    """Return what `update` makes of the tracks, and `corrected` of the target's company.

    ``doubted (run, sensor, d, doubt)``; a single sensor of two components has compiled loops.
    """
    if scan.derivative.shape[2:4] == (1, 2) and compiled.available():
        return _by_loops(tracks, beside, scan, doubted, noise, gate, weigh)
    tracks, made, judged = update(tracks, scan, noise, gate, weigh)
    return tracks, *corrected(beside, made, doubted), judged


def _by_loops(
    tracks: Tracks,
    beside: Beside,
    scan: Scan,
    doubted: Array,
    noise: Array,
    gate: float,
    weigh: Weigh,
) -> tuple[Tracks, Beside, Evidence, Judged]:
    from debrisest.filters.association import update_loops

    each = tracks.state.shape[:2]
    state, covariance = (part.reshape(-1, *part.shape[2:]).copy() for part in tracks)
    innovation, h = (part.reshape(-1, *part.shape[3:]) for part in scan)
    present, distance = update_loops.judge(innovation, h, covariance, noise, gate)
    distances = distance.reshape(*each, 1, -1)
    probability = weigh(distances)
    flat = probability.reshape(distance.shape)
    moved = update_loops.move(innovation, distance, flat, h, noise, state, covariance)
    tracks = Tracks(state.reshape(tracks.state.shape), covariance.reshape(tracks.covariance.shape))
    judged = Judged(
        present.reshape(distances.shape), np.isfinite(distances), distances, probability
    )
    target = tuple(part[:: each[1]] for part in moved)
    pull, apart, bank = beside.pull.copy(), beside.bank.apart.copy(), beside.bank.covariance.copy()
    score, information, likelihood = update_loops.beside(
        target, doubted[:, 0], noise, pull, apart, bank
    )
    shown = Evidence(score, 0.0 * score, information, likelihood)
    return tracks, Beside(pull, Bank(apart, bank)), shown, judged
