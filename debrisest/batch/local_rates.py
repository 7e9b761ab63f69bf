"""Attitude and rate about the middle of short windows, from attitudes of single epochs.

In a window the rotation vector from its middle is a polynomial of third degree in time; the fit is
weighted with the information of the attitudes, and far ones count less (Cauchy).
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.attitude import quaternion
from debrisest.batch.evidence import Seen
from debrisest.batch.row_median import row_median

_LARGEST_TURN = np.radians(40.0)  # over half a window
_FEWEST_EPOCHS, _FEWEST_OF_CUBIC = 5, 8
_LEAST_REACH = 0.4  # of half a window, from the middle to the farther epochs of either side
_MOST_WINDOWS = 60
_FEWEST_WINDOWS = 12
_REWEIGHTINGS = 3
_CLEAN = 0.3  # of the windows, at least, without outliers
_TOGETHER = 30_000  # epochs of windows that are fitted in one go
_SPOILT = 3.0  # chi2/dof, over that of clean windows, of one with outliers


class Local(NamedTuple):
    """Fits of windows, in the feature frame but for the attitude."""

    time: Array
    """Middle (window,), s."""
    half: float
    """Half length, s."""
    q: Array
    """``q_if (window, 4)``."""
    rate: Array
    """(window, 3), rad/s."""
    covariance: Array
    """Of the rate (window, 3, 3), larger where there are outliers."""
    noise: float
    """Root of chi2/dof of clean windows: the factor by which the noise exceeds what was said."""


def local_rates(times: Array, seen: Seen) -> Local | None:
    """Return fits of windows over the span of the attitudes, None if no window has five."""
    good = np.flatnonzero(np.isfinite(seen.q[:, 0]))
    if len(good) < _FEWEST_EPOCHS + 1:
        return None
    times, q, information = times[good], seen.q[good], seen.information[good]
    half = _half_length(times, q)
    best = None
    for _ in range(4):
        found = _fits(times, q, information, half)
        if found is not None and (best is None or len(found.time) > len(best.time)):
            best = found
        if best is not None and len(best.time) >= _FEWEST_WINDOWS:
            break
        half /= 2.0
    return best


def _half_length(times: Array, q: Array) -> float:
    """Longest lag, s, whose median turn is small enough."""
    span = times[-1] - times[0]
    step = float(np.median(np.diff(times)))
    half = 2.5 * step
    while half < span / 6.0:
        longer = 1.5 * half
        first = np.arange(len(times))
        last = np.searchsorted(times, times + longer)
        inside = last < len(times)
        first, last = first[inside], last[inside]
        close = times[last] - times[first] < 1.5 * longer
        if not close.any():
            break
        turn = quaternion.angle_between(q[first[close]], q[last[close]])
        if np.median(turn) > _LARGEST_TURN:
            break
        half = longer
    return half


def _fits(times: Array, q: Array, information: Array, half: float) -> Local | None:
    windows = _windows(times, half)
    if not len(windows):
        return None
    blocks = np.array_split(windows, -(-int(np.ptp(windows[:, 1:], axis=1).sum()) // _TOGETHER))
    fits = [_fitted(times, q, information, *block.T) for block in blocks]
    time, attitude, rate, covariance, excess = (np.concatenate(part) for part in zip(*fits))
    clean = float(np.quantile(excess, _CLEAN))
    spoilt = np.where(excess > _SPOILT * clean, excess / max(clean, 1e-300), 1.0)
    covariance = covariance * spoilt[:, None, None]
    return Local(time, half, attitude, rate, covariance, float(np.sqrt(clean)))


def _windows(times: Array, half: float) -> IntArray:
    """Return middle, first epoch and end of windows (window, 3) that reach far to both sides.

    They are spread over the epochs that can be middles, which a grid over all might miss: what
    turns into view for a few epochs at a time is gone at most others.
    """
    low = np.searchsorted(times, times - half)
    high = np.searchsorted(times, times + half + 1e-9)
    reach = np.minimum(times - times[low], times[high - 1] - times)
    middles = np.flatnonzero((high - low >= _FEWEST_EPOCHS) & (reach > _LEAST_REACH * half))
    if not len(middles):
        return np.zeros((0, 3), dtype=np.int64)
    stride = max(half / 2.0, (times[-1] - times[0]) / _MOST_WINDOWS)
    last = times[middles[-1]]
    even = np.minimum(np.arange(times[0], last + stride, stride), last)
    chosen = middles[np.unique(np.searchsorted(times[middles], even))]
    return np.stack([chosen, low[chosen], high[chosen]], axis=-1)


def _fitted(
    times: Array, q: Array, information: Array, middle: IntArray, low: IntArray, high: IntArray
) -> tuple[Array, Array, Array, Array, Array]:
    """Return middles, attitudes, rates, their covariances and chi2/dof of windows (window, ...)."""
    inside = low[:, None] + np.arange(np.max(high - low)) < high[:, None]
    epoch = np.minimum(low[:, None] + np.arange(inside.shape[1]), high[:, None] - 1)
    time, centre = times[middle], q[middle]
    turn = quaternion.log(quaternion.multiply(quaternion.conjugate(centre)[:, None], q[epoch]))
    axes = quaternion.to_matrix(centre)[:, None]
    plain = inside[..., None, None] * (np.swapaxes(axes, -1, -2) @ information[epoch] @ axes)
    off = times[epoch] - time[:, None]
    span = np.abs(off).max(axis=1)[:, None]
    powers = (off / span)[..., None] ** np.arange(4)
    cubic = high - low >= _FEWEST_OF_CUBIC
    powers[~cubic, :, 3] = 0.0
    robust = np.ones(inside.shape)
    for _ in range(_REWEIGHTINGS):
        solution, inverse, chi2 = _weighted(powers, turn, robust[..., None, None] * plain, plain)
        typical = row_median(np.where(inside, chi2, np.nan))[:, None] / 2.4
        robust = 1.0 / (1.0 + chi2 / (9.0 * np.maximum(typical, 1e-300)))
    dof = np.maximum(3.0 * (high - low) - np.where(cubic, 12.0, 9.0), 1.0)
    attitude = quaternion.multiply(centre, quaternion.exp(solution[:, 0]))
    covariance = inverse[:, 3:6, 3:6] / span[..., None] ** 2
    return time, attitude, solution[:, 1] / span, covariance, chi2.sum(axis=1) / dof


def _weighted(
    powers: Array, turn: Array, weight: Array, plain: Array
) -> tuple[Array, Array, Array]:
    """Return coefficients (window, 4, 3), their covariance, and chi2 of each epoch."""
    windows, epochs = powers.shape[:2]
    pairs = (powers[..., :, None] * powers[..., None, :]).reshape(windows, epochs, 16)
    sums = np.swapaxes(pairs, 1, 2) @ weight.reshape(windows, epochs, 9)
    hold = np.swapaxes(sums.reshape(windows, 4, 4, 3, 3), 2, 3).reshape(windows, 12, 12)
    pull = np.swapaxes(powers, 1, 2) @ (weight @ turn[..., None])[..., 0]
    inverse = np.asarray(np.linalg.pinv(hold, 1e-12, hermitian=True), dtype=np.float64)
    solution = (inverse @ pull.reshape(windows, 12, 1)).reshape(windows, 4, 3)
    residual = turn - powers @ solution
    weighted = (plain @ residual[..., None])[..., 0]
    return solution, inverse, np.sum(residual * weighted, axis=-1)
