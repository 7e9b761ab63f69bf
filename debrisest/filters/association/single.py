"""Extended Kalman filter of a target among unlabelled detections, batched over runs."""

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.association.recursion import AssociationSettings, filtered
from debrisest.filters.association.weighing import Way, Weighing
from debrisest.filters.association.weights import Validation
from debrisest.filters.estimates import Estimates
from debrisest.filters.scan_model import ScanModel

Method = Literal["probabilistic", "nearest", "known"]


def associated(
    model: ScanModel,
    state: Array,
    covariance: Array,
    scans: Array,
    validation: Validation,
    *,
    method: Method = "probabilistic",
    stacked: bool = False,
    relinearise: int = 1,
    truth: Array | None = None,
    restless: bool = False,
    keep: Sequence[int] = (),
) -> Estimates:
    """Filter a batch of runs, each with one target.

    `state` (run, n) and `covariance` (run, n, n) are the prior of epoch 0, which scan 0 updates;
    `scans` (run, time, sensor, detection, d) in any order, NaN-padded; `keep` lists the epochs
    whose full covariance is wanted. The `method` says which detection is the target's:

    * `"probabilistic"`: each validated one, with its probability (Bar-Shalom and Tse 1975);
    * `"nearest"`: the nearest validated one, as if that were certain;
    * `"known"`: the only one of the scan (see `labelled`), however far it is.

    Sensors update one after the other, or `stacked` with one gain. All are linearised about the
    same state, whose own errors are then carried linearly (`relinearise`, in epochs):

    * 1: about the prediction, the extended filter;
    * 0: about the start, propagated and never corrected, the small-disturbance filter of Li et al.;
      its covariance does not know what the linearisation costs;
    * else: about the start, moved to the estimate every so many epochs;
    * `truth` (run, time, n) overrules: no estimator, but with `"known"` the efficient one.

    A `restless` estimate is that of two filters, one of which expects more process noise than the
    model has (see `restless`); the detections are judged by the track all the same.

    The NIS of a sensor is the mean of the squared distances of the validated detections, by their
    probabilities; `nis_dof` counts its d components. It is chi-square for `"known"` only, and there
    not if `stacked`: else it is cut off at the gate, and drawn to small values by the choice.
    """
    gate = np.inf if method == "known" else validation.gate
    weigh = _weighing(validation, method, scans)
    every = relinearise if truth is None else 0
    settings = AssociationSettings(gate, weigh, stacked, every, truth, restless)
    return filtered(model, state[:, None], covariance[:, None], scans, settings, keep)


def jointly_associated(
    model: ScanModel,
    state: Array,
    covariance: Array,
    scans: Array,
    validation: Validation,
    *,
    stacked: bool = False,
    keep: Sequence[int] = (),
) -> Estimates:
    """Filter a batch of runs, each with a target and neighbours that give detections as well.

    As `associated`, with `state` (run, track, n) and `covariance` (run, track, n, n): track 0 is
    the target, whose estimates come back. No detection is that of two tracks (Fortmann, Bar-Shalom
    and Scheffe 1983). A track that is NaN is not there.
    """
    weigh = Weighing("joint", validation.checked(), scans.shape[-1])
    settings = AssociationSettings(validation.gate, weigh, stacked, relinearise=1, truth=None)
    return filtered(model, state, covariance, scans, settings, keep)


def labelled(scans: Array, index: IntArray) -> Array:
    """Return scans that hold nothing but the detection `index` (run, time, sensor); -1 is none."""
    chosen = np.maximum(index, 0)[..., None, None]
    return np.where(index[..., None, None] >= 0, np.take_along_axis(scans, chosen, axis=-2), np.nan)


def _weighing(validation: Validation, method: Method, scans: Array) -> Weighing:
    if method not in get_args(Method):
        raise ValueError(f"method must be one of {get_args(Method)}, not {method!r}")
    if method == "known" and scans.shape[-2] != 1:
        raise ValueError(f"known detections come alone in their scan, not {scans.shape[-2]}")
    way: Way = "probabilistic" if method == "probabilistic" else "nearest"
    return Weighing(way, validation.checked(), scans.shape[-1])
