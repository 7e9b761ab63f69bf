"""Recursion of the association filters: predict, then update sensor by sensor."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, IntArray
from debrisest.filters.association import by_loops
from debrisest.filters.association.companions import pairs, unclaimed
from debrisest.filters.association.evidence import (
    Beside,
    Evidence,
    corrected,
    no_evidence,
    nothing_yet,
    predicted,
)
from debrisest.filters.association.restless import Bank, mixed
from debrisest.filters.association.update import Judged, Scan, Tracks, Weigh, update
from debrisest.filters.association.weighing import Weighing
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.runs import take
from debrisest.filters.scan_model import ScanModel

COUNTED = ("rejected", "validated", "looked", "matched", "mistaken", "near", "ring")
"""What is counted at every epoch: as in `_Seen`, and pairs of detections beside the target."""


class AssociationSettings(NamedTuple):
    """How detections are judged, and about what the model is linearised."""

    gate: float
    weigh: Weigh
    stacked: bool
    """Whether the sensors update together."""
    relinearise: int
    """Epochs from one linearisation about the estimate to the next, 0: never."""
    truth: Array | None
    """What to linearise about instead, (run, time, n)."""
    restless: bool = False
    """Whether the estimate is the mixture of the track's bank, and not the track."""

    def of(self, runs: IntArray) -> "AssociationSettings":
        """Return the settings for some runs."""
        return self if self.truth is None else self._replace(truth=self.truth[runs])


class _Seen(NamedTuple):
    """What the target's track made of the detections of an epoch, each (run,)."""

    nis: Array
    nis_dof: IntArray
    rejected: IntArray
    validated: IntArray
    looked: IntArray
    """Sensors that showed anything, and of those how many something in the gate."""
    matched: IntArray
    mistaken: Array
    """Probability that the nearest point is another's, summed over the sensors."""

    def plus(self, judged: Judged, d: int) -> "_Seen":
        """Add the detections of further sensors."""
        probability, distance = judged.probability[:, 0], judged.distance[:, 0]
        detected = probability.sum(-1)
        weighed = np.where(probability > 0.0, probability * distance, 0.0).sum(-1)
        squared = np.where(detected > 0.0, weighed / detected, 0.0)
        outside = judged.present[:, 0] & ~judged.valid[:, 0]
        inside = judged.valid[:, 0].sum(-1)
        return _Seen(
            self.nis + squared.sum(-1),
            self.nis_dof + d * (detected > 0.0).sum(-1),
            self.rejected + d * outside.sum((-2, -1)),
            self.validated + inside.sum(-1),
            self.looked + judged.present[:, 0].any(-1).sum(-1),
            self.matched + (inside > 0).sum(-1),
            self.mistaken + _mistaken(distance).sum(-1),
        )


def _mistaken(distance: Array) -> Array:
    """Probability that of squared distances (..., detection) the least is not the target's."""
    ratio = np.exp(0.5 * (np.min(distance, axis=-1, keepdims=True, initial=np.inf) - distance))
    return np.where(np.isfinite(distance).any(-1), 1.0 - 1.0 / np.nansum(ratio, axis=-1), 0.0)


class _Look(NamedTuple):
    """What an epoch shows beside the state."""

    seen: _Seen
    evidence: Evidence
    others: Array
    """Detections that are likely no track's, (run, sensor, detection, d)."""


def filtered(
    model: ScanModel,
    state: Array,
    covariance: Array,
    scans: Array,
    settings: AssociationSettings,
    keep: Sequence[int],
) -> Estimates:
    """Return the estimates of track 0; `state` (run, track, n), else as `associated`.

    The counts hold sums over the epochs too, the `Evidence` by its names. Sensors of two components
    that update one after the other have compiled loops.
    """
    one_by_one = scans.shape[-1] == 2 and not (settings.stacked and scans.shape[2] > 1)
    if one_by_one and len(state) and isinstance(settings.weigh, Weighing) and compiled.available():
        return by_loops.filtered(model, state, covariance, scans, settings, keep)
    names, epochs, counts = model.error_names, scans.shape[1], dict.fromkeys(COUNTED, 0.0)
    start = state[:, 0], covariance[:, 0]
    writer = EstimatesWriter(names, *start, epochs, keep, counts, totals=["repairs"])
    tracks, nominal, going = Tracks(state, covariance), state, writer.runs
    beside, evidence = nothing_yet(model, *start)
    before = np.full((len(state), *scans.shape[2:]), np.nan)
    with np.errstate(all="ignore"):
        for k in range(epochs):
            if len(going) < len(nominal):
                model, tracks, nominal = model.of(going), take(tracks, going), nominal[going]
                scans, settings, before = scans[going], settings.of(going), before[going]
                beside = take(beside, going)
            if len(going) == 0:
                break
            if k > 0:
                tracks, beside, nominal = _predict(model, tracks, beside, nominal, k - 1)
            if settings.truth is not None:
                nominal = settings.truth[:, None, k]
            tracks, beside, look = _look(model, tracks, beside, nominal, scans[:, k], settings, k)
            evidence.add(writer.runs, look.evidence)
            (near, ring), before = pairs(before, look.others, model.noise), look.others
            if settings.relinearise > 0 and (k + 1) % settings.relinearise == 0:
                nominal = tracks.state
            bank = beside.bank if settings.restless else None
            target = _estimate(tracks, bank, evidence.likelihood[writer.runs])
            going = writer.record(k, *target, look.seen._asdict() | {"near": near, "ring": ring})
    found = writer.estimates()
    return found._replace(counts=found.counts | evidence._asdict())


def _estimate(tracks: Tracks, bank: Bank | None, likelihood: Array) -> tuple[Array, Array]:
    """State and covariance of the target; of the bank's mixture, if it is given."""
    if bank is None:
        return tracks.state[:, 0], tracks.covariance[:, 0]
    return mixed(bank, likelihood, tracks.state[:, 0])


def _predict(
    model: ScanModel, tracks: Tracks, beside: Beside, nominal: Array, k: int
) -> tuple[Tracks, Beside, Array]:
    moved, transition = model.moved(nominal, k)
    transposed = np.swapaxes(transition, -2, -1)
    lag = (tracks.state - nominal)[..., None, :] @ transposed
    covariance = transition @ tracks.covariance @ transposed
    covariance = 0.5 * (covariance + np.swapaxes(covariance, -2, -1)) + model.process_noise
    beside = predicted(beside, transition[:, 0], model.process_noise)
    return Tracks(moved + lag[..., 0, :], covariance), beside, moved


def _look(
    model: ScanModel,
    tracks: Tracks,
    beside: Beside,
    nominal: Array,
    scan: Array,
    settings: AssociationSettings,
    k: int,
) -> tuple[Tracks, Beside, _Look]:
    """Update by all sensors; `scan` is (run, sensor, detection, d)."""
    shown, h, doubted = model.seen(nominal, k)
    nothing = np.zeros(len(scan), dtype=np.int64)
    zero = nothing.astype(np.float64)
    seen = _Seen(zero, nothing, nothing, nothing, nothing, nothing, zero)
    evidence = no_evidence(len(scan), len(model.doubts))
    others = np.full(scan.shape, np.nan)
    for group in _groups(shown.shape[-2], settings.stacked):
        lag = tracks.state - nominal
        predicted = shown[:, :, group] + (h[:, :, group] @ lag[:, :, None, :, None])[..., 0]
        innovation = scan[:, None, group] - predicted[..., None, :]
        part = Scan(innovation, h[:, :, group])
        judge = model.noise, settings.gate, settings.weigh
        tracks, made, judged = update(tracks, part, *judge)
        beside, more = corrected(beside, made, doubted[:, group])
        seen = seen.plus(judged, shown.shape[-1])
        evidence = evidence.plus(more)
        others[:, group] = unclaimed(innovation, judged)
    return tracks, beside, _Look(seen, evidence, others)


def _groups(sensors: int, stacked: bool) -> list[slice]:
    """Sensors that update together."""
    return [slice(None)] if stacked else [slice(s, s + 1) for s in range(sensors)]
