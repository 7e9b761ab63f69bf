"""Update of tracks by the detections of one or more sensors, each with the probability to be it.

Axes of all arrays: run, track, sensor, detection, as far as they have them, then components.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.filters.linear_algebra import solve

Weigh = Callable[[Array], Array]
"""From squared distances (run, track, sensor, detection), infinite where not validated, to the
probabilities of the detections."""


class Tracks(NamedTuple):
    """Gaussian beliefs."""

    state: Array
    """(run, track, n)."""
    covariance: Array
    """(run, track, n, n)."""


class Scan(NamedTuple):
    """What sensors show, compared with what was predicted."""

    innovation: Array
    """Detection minus prediction (run, track, sensor, detection, d), NaN where there is none."""
    derivative: Array
    """H of each sensor, (run, track, sensor, d, n); NaN where nothing can be predicted."""


class Judged(NamedTuple):
    """What was made of the detections, each (run, track, sensor, detection)."""

    present: BoolArray
    valid: BoolArray
    distance: Array
    """Squared, infinite where not validated."""
    probability: Array


class Correction(NamedTuple):
    """How an update moves tracks, by the m components of its sensors; (run, track, ...)."""

    innovation: Array
    """Combined, (..., m), zero where there is none."""
    total: Array
    """Covariance of an innovation that is certain, S, (..., m, m)."""
    own: Array
    """The part of it that is the tracks', H P H^T."""
    shown: Array
    """H of what is used, zero elsewhere, (..., m, n)."""
    trusted: Array
    """Probability that the target's detection is among the validated, (..., m)."""
    spread: Array
    """Covariance of `innovation` about that share of the tracks' error, (..., m, m)."""
    gain: Array
    """K, transposed, (..., m, n)."""


class _Moments(NamedTuple):
    """Of the innovation of each sensor."""

    detected: Array
    """Probability that the target's detection is among the validated, 1 - beta_0."""
    mean: Array
    """Combined innovation, (run, track, sensor, d)."""
    spread: Array
    """Of the innovation about `mean`, (run, track, sensor, d, d)."""


def update(
    tracks: Tracks, scan: Scan, noise: Array, gate: float, weigh: Weigh
) -> tuple[Tracks, Correction, Judged]:
    """Return the moments of the posterior mixture of which detection is whose.

    All sensors share one gain, K of the stacked H. A sensor s whose detection is right with the
    probability b_s moves the mean by K_s times its combined innovation, and

        P+ = (I - K B H) P (I - K B H)^T + K blkdiag(b_s R + b_s (1 - b_s) H_s P H_s^T + P~_s) K^T,

    the expectation over the sensors being right or not, independently, each with its b_s; P~_s is
    the spread of the innovation. For one sensor it is the equation of probabilistic data
    association (Li et al., Eq. 16) in Joseph's form. That equation has a single beta_0, which does
    not serve two sensors. A sensor without a validated detection is left out of the stack.
    """
    usable = np.asarray(np.isfinite(scan.derivative).all((-2, -1)))
    h = np.where(usable[..., None, None], scan.derivative, 0.0)
    shown = h @ tracks.covariance[:, :, None] @ np.swapaxes(h, -2, -1)
    judged, innovation = _judge(scan.innovation, usable, shown + noise, gate, weigh)
    moments = _moments(innovation, judged.probability)
    used = np.asarray(judged.valid.any(-1))[..., None, None]
    return *_moved(tracks, np.where(used, h, 0.0), shown, noise, moments), judged


def _judge(
    innovation: Array, usable: BoolArray, total: Array, gate: float, weigh: Weigh
) -> tuple[Judged, Array]:
    """Detections by their distances, for which all those of a sensor share one solution with S."""
    present = usable[..., None] & np.isfinite(innovation).all(-1)
    nu = np.where(present[..., None], innovation, 0.0)
    white = np.swapaxes(solve(total, np.swapaxes(nu, -2, -1)), -2, -1)
    distance = (nu * white).sum(-1)
    valid = present & (distance <= gate)
    distance = np.where(valid, distance, np.inf)
    return Judged(present, valid, distance, weigh(distance)), nu


def _moments(innovation: Array, probability: Array) -> _Moments:
    detected = np.minimum(probability.sum(-1), 1.0)
    mean = probability[..., None, :] @ innovation
    apart = innovation - mean
    spread = np.swapaxes(probability[..., None] * apart, -2, -1) @ apart
    rest = (1.0 - detected)[..., None, None] * np.swapaxes(mean, -2, -1) * mean
    return _Moments(detected, mean[..., 0, :], spread + rest)


def _moved(
    tracks: Tracks, h: Array, shown: Array, noise: Array, moments: _Moments
) -> tuple[Tracks, Correction]:
    b = moments.detected[..., None, None]
    stacked, trusted = _stacked(h), _stacked(b * h)
    cross = stacked @ tracks.covariance
    every = np.broadcast_to(noise, shown.shape)
    own = cross @ np.swapaxes(stacked, -2, -1)
    total = own + _block_diagonal(every)
    gain = solve(total, cross)
    innovation = moments.mean.reshape(stacked.shape[:-1])
    correction = innovation[..., None, :] @ gain
    kept = np.eye(h.shape[-1]) - np.swapaxes(trusted, -2, -1) @ gain
    spread = _block_diagonal(b * every + b * (1.0 - b) * shown + moments.spread)
    covariance = np.swapaxes(kept, -2, -1) @ tracks.covariance @ kept
    covariance = covariance + np.swapaxes(gain, -2, -1) @ spread @ gain
    moved = Tracks(
        state=tracks.state + correction[..., 0, :],
        covariance=0.5 * (covariance + np.swapaxes(covariance, -2, -1)),
    )
    each = np.broadcast_to(b[..., 0], moments.mean.shape).reshape(innovation.shape)
    return moved, Correction(innovation, total, own, stacked, each, spread, gain)


def _stacked(h: Array) -> Array:
    return h.reshape(*h.shape[:2], -1, h.shape[-1])


def _block_diagonal(blocks: Array) -> Array:
    """One matrix (run, track, sensor d, sensor d) of the sensors' (run, track, sensor, d, d)."""
    sensors, d = blocks.shape[-3:-1]
    if sensors == 1:
        return blocks[:, :, 0]
    full = np.zeros((*blocks.shape[:2], sensors, d, sensors, d))
    for s in range(sensors):
        full[:, :, s, :, s] = blocks[:, :, s]
    return full.reshape(*blocks.shape[:2], sensors * d, sensors * d)
