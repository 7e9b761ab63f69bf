"""Few lines off any grid, common to all components of a signal with missing samples.

The attitude of a body free of torque is quasi-periodic, so that its components are sums of sines
with few frequencies, the same ones in all of them:

    x_d(t) = a_d + sum_k b_kd cos(w_k t) + c_kd sin(w_k t)

Lines are taken one at a time from the peak of the residual's periodogram, as in orthogonal matching
pursuit (Pati et al. 1993), and after each one all frequencies are refined together. An epoch that
is not observed is not in the sums; nothing is filled in.
"""

from typing import NamedTuple

import numpy as np
import scipy

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.outcome import Outcome
from debrisest.recovery.line_fit import LineFit, Signals, fit_lines, lines_at, refine_lines

_PADDING = 4
"""Points of the periodogram per resolution: its peak is near enough to be refined."""
_DEVIATIONS = 5.0
"""Of the correlation of successive white residuals, beyond which they are not white."""
_RUNS_IN_CACHE = 4
_PRECISION = 1e-16
"""Share of a signal's energy below which what is left is rounding."""


class LineStatus(Outcome):
    """How the search for lines ended; `sentence` tells the user."""

    COMPLETE = 0, "complete: another line would explain no more than noise"
    LINE_LIMIT = (
        1,
        "stopped at the most lines: allow more, or recover by basis pursuit if they never suffice",
    )
    NOT_WHITE = (
        2,
        "what is left is no white noise: the motion is not a sum of few sines, recover by basis "
        "pursuit",
    )
    NO_SAMPLE = 3, "no sample observed: nothing to recover from, the signal is zero"


class LineSpectrum(NamedTuple):
    """The lines of every signal of a batch (run)."""

    signal: Array
    """(run, time, component) at all epochs, observed or not."""
    frequency: Array
    """(run, line), radians per epoch, in the order they were found; NaN beyond the last one."""
    status: IntArray
    """`LineStatus` (run)."""


def line_spectrum(samples: Array, weight: Array | None = None, most: int = 30) -> LineSpectrum:
    """Recover signals `samples` (run, time, component); an epoch with a NaN is not observed.

    `weight` (run, time) is that of each epoch, the inverse of its noise variance up to a factor;
    `most` is the largest number of lines. A line is added as long as it lowers the criterion for
    sines in white noise of unknown variance (Djuric 1996), N ln(cost) + (amplitudes + 3
    frequencies) ln N with N the number of samples. A run does not depend on the others.
    """
    signals = _signals(samples, np.ones(samples.shape[:-1]) if weight is None else weight)
    found = LineSpectrum(
        np.zeros(samples.shape),
        np.full((len(samples), most), np.nan),
        np.where(signals.epochs > 0, LineStatus.LINE_LIMIT, LineStatus.NO_SAMPLE),
    )
    for begin in range(0, len(samples), _RUNS_IN_CACHE):
        block = slice(begin, begin + _RUNS_IN_CACHE)
        part = LineSpectrum(found.signal[block], found.frequency[block], found.status[block])
        _find(part, signals.take(block), most)
    return found


def _find(found: LineSpectrum, signals: Signals, most: int) -> None:
    """Put lines and status of each run in their place."""
    status = found.status
    room = np.minimum(most, (signals.epochs - 1) // 3)
    active = np.flatnonzero(signals.epochs)
    fit = fit_lines(signals.take(active), np.empty((active.size, 0)))
    _keep(found, active, fit)
    for count in range(1, most + 1):
        may = count <= room[active]
        active, fit = active[may], fit.take(may)
        if not active.size:
            break
        now = signals.take(active)
        longer = _one_line_more(now, fit)
        better = _criterion(now, longer) < _criterion(now, fit)
        status[active[~better]] = LineStatus.COMPLETE
        active, fit = active[better], longer.take(better)
        _keep(found, active, fit)
    white = _is_white(signals, found.signal)
    status[(status == LineStatus.COMPLETE) & ~white] = LineStatus.NOT_WHITE


def _signals(samples: Array, weight: Array) -> Signals:
    observed = np.asarray(np.isfinite(samples).all(axis=-1))
    return Signals(np.where(observed[..., None], samples, 0.0), np.where(observed, weight, 0.0))


def _one_line_more(signals: Signals, fit: LineFit) -> LineFit:
    """Return the refined fit with a line at the highest peak of what is left."""
    residual = signals.samples - lines_at(fit, signals.samples.shape[1])
    length = scipy.fft.next_fast_len(_PADDING * residual.shape[1], real=True)
    spectrum = scipy.fft.rfft(residual * signals.weight[..., None], length, axis=1)
    power = np.sum(np.abs(spectrum[:, 1:]) ** 2, axis=-1)
    peak = 2.0 * np.pi / length * (1 + np.argmax(power, axis=-1))
    return refine_lines(signals, np.concatenate([fit.frequency, peak[:, None]], axis=-1))


def _criterion(signals: Signals, fit: LineFit) -> Array:
    """Return what the best number of lines has the least of (run)."""
    count = signals.epochs * signals.samples.shape[-1]
    unknowns = fit.amplitude[0].size + 3 * fit.frequency.shape[-1]
    cost = np.maximum(fit.cost, _PRECISION * signals.energy + np.finfo(float).tiny)
    return np.asarray(count * np.log(cost) + unknowns * np.log(count))


def _is_white(signals: Signals, found: Array) -> BoolArray:
    """Return whether what is left (run, time, component) has no memory of the epoch before.

    The components of an epoch count as one number: their noise may be the same.
    """
    left = signals._replace(samples=signals.samples - found)
    residual = left.samples * left.weight[..., None] ** 0.5
    product = np.sum(residual[:, 1:] * residual[:, :-1], axis=(-2, -1))
    pairs = np.sum(left.weight[:, 1:] * left.weight[:, :-1] > 0, axis=-1)
    limit = _DEVIATIONS * left.energy * np.sqrt(pairs) / np.maximum(left.epochs, 1)
    return np.asarray((product <= limit) | (left.energy <= _PRECISION * signals.energy))


def _keep(found: LineSpectrum, runs: IntArray, fit: LineFit) -> None:
    found.signal[runs] = lines_at(fit, found.signal.shape[1])
    found.frequency[runs, : fit.frequency.shape[-1]] = np.abs(fit.frequency)
