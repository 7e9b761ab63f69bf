"""Attitude and rate without a law of motion: a smoother for any rotation.

The angular acceleration, or its derivative, is white noise between epochs; which of the two, and
its intensity, is found by maximum likelihood. The errors (6 or 9) are the rotation vector in
inertial axes, the rate and perhaps the acceleration in the feature frame. Forward a Kalman filter
in information form, which takes what `Evidence` tells, then the recursion of Rauch, Tung and
Striebel.
"""

from functools import lru_cache
from math import factorial
from typing import NamedTuple

import numpy as np

from debrisest import compiled
from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.attitude import quaternion
from debrisest.batch.evidence import Evidence
from debrisest.batch.local_rates import Local
from debrisest.batch.path import Path, unknown_path
from debrisest.batch.point_sums import KnownPoints

_UPDATES = 2  # of an epoch, each about the last
_COARSE, _FINE = np.logspace(-6.0, 5.0, 12), np.logspace(-0.8, 0.8, 9)
_ORDERS = (2, 3)


class Wander(NamedTuple):
    """What the likelihood says of a wandering rate."""

    order: int
    """2: the acceleration is white, 3: its derivative is."""
    intensity: float
    """Of the white noise, in units of the noise's variance factor, rad^2/s^3 or rad^2/s^5."""
    noise: float
    """Factor on the measurements' standard deviations."""


class _State(NamedTuple):
    """One epoch of one filter for each intensity."""

    q: Array
    motion: Array
    """Rate and perhaps acceleration, one after the other (..., 3 or 6)."""
    spread: Array

    def moved(self, error: Array) -> tuple[Array, Array]:
        """Return attitude and motion moved by errors."""
        q = quaternion.multiply(quaternion.exp(error[:, :3]), self.q)
        return q, self.motion + error[:, 3:]


class _Track(NamedTuple):
    """A filter's way over the epochs, and its likelihood."""

    predicted: list[_State]
    filtered: list[_State]
    transition: list[Array]
    misfit: Array
    volume: Array


def wander(evidence: Evidence, local: Local) -> Wander:
    """Return law, intensity and noise that make the measurements most likely."""
    found = [_most_likely(evidence, local, order) for order in _ORDERS]
    return min(found, key=lambda pair: pair[0])[1]


def _most_likely(evidence: Evidence, local: Local, order: int) -> tuple[float, Wander]:
    changes = np.sum(np.diff(local.rate, axis=0) ** 2) / len(local.rate)
    floor = float(np.median(np.trace(local.covariance, axis1=1, axis2=2)))
    middle = max(changes, floor) / local.half ** (2 * order - 3)
    dof = max(float(evidence.dof.sum()), 1.0)
    best = (np.inf, Wander(order, middle, 1.0))
    for factors in (_COARSE, _FINE):
        intensity = best[1].intensity * factors
        misfit, volume = _likelihoods(evidence, local, order, intensity)
        excess = np.clip(misfit / dof, 1e-12, 1e12)
        unlikely = misfit / excess + dof * np.log(excess) + volume
        at = int(np.argmin(np.where(np.isfinite(unlikely), unlikely, np.inf)))
        wanders = Wander(order, float(intensity[at]), float(np.sqrt(excess[at])))
        best = (float(unlikely[at]), wanders)
    return best


def _likelihoods(
    evidence: Evidence, local: Local, order: int, intensity: Array
) -> tuple[Array, Array]:
    """Return misfit and volume (intensity,) of a filter with each intensity."""
    if isinstance(evidence, KnownPoints) and compiled.available():
        from debrisest.batch import smoother_loops

        clock, start = _for_loops(evidence, local, order, evidence.times)
        return smoother_loops.likelihoods(clock, evidence.loop_sums, start, intensity)
    track = _forward(evidence, local, order, intensity, evidence.times)
    return track.misfit, track.volume


def smooth(evidence: Evidence, local: Local, found: Wander, times: Array) -> Path:
    """Return the motion at ``times (time,)``, s, that all measurements make most likely.

    NaN before the first epoch that tells its attitude.
    """
    scaled = evidence.scaled(found.noise)
    merged, _ = _merged(scaled, times)
    q, motion, spread = _smoothed(scaled, local, found, times)
    path = unknown_path(merged)._replace(
        q=q,
        rate=motion[:, :3],
        turn_covariance=spread[:, :3, :3],
        rate_covariance=spread[:, 3:6, 3:6],
    )
    chosen = path.at(np.searchsorted(merged, np.maximum(times, merged[0])))
    for part in chosen[1:]:
        part[times < merged[0]] = np.nan
    return chosen._replace(times=times)


def _smoothed(
    evidence: Evidence, local: Local, found: Wander, times: Array
) -> tuple[Array, Array, Array]:
    """Return attitudes, motions and covariances (time, ...) of a filter's way and back."""
    intensity = found.intensity * found.noise**2
    if isinstance(evidence, KnownPoints) and compiled.available():
        from debrisest.batch import smoother_loops

        clock, start = _for_loops(evidence, local, found.order, times)
        return smoother_loops.smoothed(clock, evidence.loop_sums, start, intensity)
    steps = _backward(_forward(evidence, local, found.order, np.array([intensity]), times))
    q, motion, spread = (np.array([step[part][0] for step in steps]) for part in range(3))
    return q, motion, spread


def _for_loops(
    evidence: KnownPoints, local: Local, order: int, times: Array
) -> tuple[tuple[Array, IntArray], tuple[Array, Array, Array]]:
    """Return clock and start as `smoother_loops` take them."""
    merged, epochs = _merged(evidence, times)
    start = _start(evidence, local, order, 1)
    clock = np.diff(merged, prepend=merged[0]), epochs
    return clock, (start.q[0], start.motion[0], start.spread[0])


def _merged(evidence: Evidence, times: Array) -> tuple[Array, IntArray]:
    """Return times from the first attitude on, and the epoch measured at each, -1 if none."""
    first = evidence.times[np.argmax(np.isfinite(evidence.seen().q[:, 0]))]
    merged = np.union1d(evidence.times, times)
    merged = merged[merged >= first]
    at = np.minimum(np.searchsorted(evidence.times, merged), len(evidence.times) - 1)
    return merged, np.where(evidence.times[at] == merged, at, -1)


def _start(evidence: Evidence, local: Local, order: int, copies: int) -> _State:
    seen = evidence.seen()
    first = int(np.argmax(np.isfinite(seen.q[:, 0])))
    nearest = int(np.argmin(np.abs(local.time - evidence.times[first])))
    turn = 1e-12 if evidence.of_rate else 1.0
    speed2 = np.max(np.sum(local.rate**2, axis=-1)) + np.trace(local.covariance[nearest])
    variance = [turn, speed2, speed2 / local.half**2][:order]
    motion = np.concatenate([local.rate[nearest], np.zeros(3 * order - 6)])
    return _State(
        np.tile(seen.q[first], (copies, 1)),
        np.tile(motion, (copies, 1)),
        np.tile(np.diag(np.repeat(variance, 3)), (copies, 1, 1)),
    )


def _forward(
    evidence: Evidence, local: Local, order: int, intensity: Array, times: Array
) -> _Track:
    """Filter once for each intensity."""
    merged, epochs = _merged(evidence, times)
    state = _start(evidence, local, order, len(intensity))
    track = _Track([], [], [], *np.zeros((2, len(intensity))))
    for step, epoch in zip(np.diff(merged, prepend=merged[0]), epochs):
        with np.errstate(all="ignore"):
            state, transition = _predicted(state, float(step), intensity, order)
            track.transition.append(transition)
            track.predicted.append(state)
            if epoch >= 0:
                state = _updated(evidence, int(epoch), state, track)
        track.filtered.append(state)
    return track


def _predicted(state: _State, step: float, intensity: Array, order: int) -> tuple[_State, Array]:
    taylor, whole, noise, onward = _chain(step, order)
    turn = np.tensordot(taylor, state.motion.reshape(-1, order - 1, 3), ((0,), (1,)))
    frame = np.tile(np.eye(3 * order), (len(state.q), 1, 1))
    middle = quaternion.multiply(state.q, quaternion.exp(0.5 * turn))
    frame[:, :3, :3] = quaternion.to_matrix(middle)
    back = np.swapaxes(frame, -1, -2)
    transition = frame @ whole @ back
    added = intensity[:, None, None] * (frame @ noise @ back)
    motion = state.motion @ onward
    q = quaternion.multiply(state.q, quaternion.exp(turn))
    spread = transition @ state.spread @ np.swapaxes(transition, -1, -2) + added
    return _State(q, motion, spread), transition


@lru_cache(maxsize=32)
def _chain(step: float, order: int) -> tuple[Array, Array, Array, Array]:
    """How integrators in a row go on over a step, the last fed by white noise, along three axes.

    What the first has of the others (order - 1,), the transition and the noise (3 order, 3 order),
    and the transition of all but the first, transposed.
    """
    taylor, noise = np.zeros((2, order, order))
    for i in range(order):
        for j in range(order):
            left, right = order - 1 - i, order - 1 - j
            power = left + right + 1
            noise[i, j] = step**power / (power * factorial(left) * factorial(right))
            if j >= i:
                taylor[i, j] = step ** (j - i) / factorial(j - i)
    whole, fed, onward = (
        np.asarray(np.kron(part, np.eye(3)), dtype=np.float64)
        for part in (taylor, noise, taylor[1:, 1:])
    )
    return taylor[0, 1:], whole, fed, onward.T


def _updated(evidence: Evidence, epoch: int, state: _State, track: _Track) -> _State:
    """Return the state after an epoch, and add its likelihood to the track."""
    part = slice(3, 6) if evidence.of_rate else slice(0, 3)
    across, own = state.spread[:, :, part], state.spread[:, part, part]
    error = np.zeros(state.spread.shape[:-1])
    for update in range(_UPDATES):
        q, motion = state.moved(error)
        told = evidence.told(q, motion[:, :3], epoch)
        wider, sound = _sound(np.eye(3) + told.hold @ own)
        inverse = np.linalg.inv(wider)
        pull = told.pull + (told.hold @ error[:, part, None])[..., 0]
        step = across @ inverse @ pull[..., None]
        if update == 0:
            track.misfit[:] += told.chi2 - np.sum(told.pull * step[:, part, 0], axis=-1)
            track.misfit[~sound] = np.inf
            track.volume[:] += np.log(np.abs(np.linalg.det(wider)))
        error = step[..., 0]
    spread = state.spread - across @ inverse @ told.hold @ np.swapaxes(across, -1, -2)
    return _State(*state.moved(error), 0.5 * (spread + np.swapaxes(spread, -1, -2)))


def _sound(matrix: Array) -> tuple[Array, BoolArray]:
    """Return matrices that can be inverted, and which were so: a filter may diverge."""
    with np.errstate(all="ignore"):
        sound = np.isfinite(matrix).all(axis=(-2, -1)) & (np.abs(np.linalg.det(matrix)) > 0.0)
    return np.where(sound[:, None, None], matrix, np.eye(3)), sound


def _backward(track: _Track) -> list[_State]:
    steps = [track.filtered[-1]]
    for k in range(len(track.filtered) - 2, -1, -1):
        state, ahead, after = track.filtered[k], track.predicted[k + 1], steps[-1]
        across = track.transition[k + 1] @ state.spread
        scale = np.sqrt(np.diagonal(ahead.spread, 0, -2, -1))[..., None]
        scaled = ahead.spread / scale / np.swapaxes(scale, -1, -2)
        gain = np.swapaxes(np.linalg.solve(scaled, across / scale) / scale, -1, -2)
        turn = quaternion.log(quaternion.multiply(after.q, quaternion.conjugate(ahead.q)))
        error = np.concatenate([turn, after.motion - ahead.motion], axis=-1)
        moved = state.moved((gain @ error[..., None])[..., 0])
        change = gain @ (after.spread - ahead.spread) @ np.swapaxes(gain, -1, -2)
        steps.append(_State(*moved, state.spread + change))
    return steps[::-1]
