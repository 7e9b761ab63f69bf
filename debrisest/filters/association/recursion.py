"""Recursion of the association filters: predict, then update sensor by sensor."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.association.update import Judged, Scan, Tracks, Weigh, update
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.runs import take
from debrisest.filters.scan_model import ScanModel

COUNTED = ("rejected", "validated", "looked", "matched", "crowded", "product", "square")
"""What is counted at every epoch: `_Seen`, and products of innovations with those before them."""
_MEMORY = 0.8
"""By which the innovations before are weighed from one epoch to the next."""


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
    """Sensors that showed anything, of those how many something in the gate, and how many more than
    one point."""
    matched: IntArray
    crowded: IntArray

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
            self.crowded + (inside > 1).sum(-1),
        )


def filtered(
    model: ScanModel,
    state: Array,
    covariance: Array,
    scans: Array,
    settings: AssociationSettings,
    keep: Sequence[int],
) -> Estimates:
    """Return the estimates of track 0; `state` (run, track, n), else as `associated`."""
    names, epochs, counts = model.error_names, scans.shape[1], dict.fromkeys(COUNTED, 0.0)
    start = state[:, 0], covariance[:, 0]
    writer = EstimatesWriter(names, *start, epochs, keep, counts, totals=["repairs"])
    tracks, nominal, going = Tracks(state, covariance), state, writer.runs
    before = np.zeros((len(state), scans.shape[2], scans.shape[-1]))
    with np.errstate(all="ignore"):
        for k in range(epochs):
            if len(going) < len(nominal):
                model, tracks, nominal = model.of(going), take(tracks, going), nominal[going]
                scans, settings, before = scans[going], settings.of(going), before[going]
            if len(going) == 0:
                break
            if k > 0:
                tracks, nominal = _predict(model, tracks, nominal, k - 1)
            if settings.truth is not None:
                nominal = settings.truth[:, None, k]
            tracks, seen, combined = _look(model, tracks, nominal, scans[:, k], settings, k)
            product, before = combined * before, _MEMORY * before + combined
            if settings.relinearise > 0 and (k + 1) % settings.relinearise == 0:
                nominal = tracks.state
            target = tracks.state[:, 0], tracks.covariance[:, 0]
            figures = {"product": product.sum((1, 2)), "square": (product**2).sum((1, 2))}
            going = writer.record(k, *target, seen._asdict() | figures)
    return writer.estimates()


def _predict(model: ScanModel, tracks: Tracks, nominal: Array, k: int) -> tuple[Tracks, Array]:
    moved = model.process(nominal, k)
    transition = np.broadcast_to(model.process_jacobian(nominal, k), tracks.covariance.shape)
    transposed = np.swapaxes(transition, -2, -1)
    lag = (tracks.state - nominal)[..., None, :] @ transposed
    covariance = transition @ tracks.covariance @ transposed
    covariance = 0.5 * (covariance + np.swapaxes(covariance, -2, -1)) + model.process_noise
    return Tracks(moved + lag[..., 0, :], covariance), moved


def _look(
    model: ScanModel,
    tracks: Tracks,
    nominal: Array,
    scan: Array,
    settings: AssociationSettings,
    k: int,
) -> tuple[Tracks, _Seen, Array]:
    """Update by all sensors; `scan` is (run, sensor, detection, d).

    The last is the combined innovation of the target's track, (run, sensor, d).
    """
    shown = model.points(nominal, k)
    h = np.broadcast_to(model.points_jacobian(nominal, k), (*shown.shape, nominal.shape[-1]))
    nothing = np.zeros(len(scan), dtype=np.int64)
    seen, combined = _Seen(nothing.astype(np.float64), *[nothing] * 6), []
    for group in _groups(shown.shape[-2], settings.stacked):
        lag = tracks.state - nominal
        predicted = shown[:, :, group] + (h[:, :, group] @ lag[:, :, None, :, None])[..., 0]
        innovation = scan[:, None, group] - predicted[..., None, :]
        part = Scan(innovation, h[:, :, group])
        tracks, judged = update(tracks, part, model.noise, settings.gate, settings.weigh)
        seen = seen.plus(judged, shown.shape[-1])
        combined.append(judged.combined[:, 0])
    return tracks, seen, np.concatenate(combined, axis=1)


def _groups(sensors: int, stacked: bool) -> list[slice]:
    """Sensors that update together."""
    return [slice(None)] if stacked else [slice(s, s + 1) for s in range(sensors)]
