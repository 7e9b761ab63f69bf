"""A given number of lines fitted to signals with missing samples, their frequencies refined.

Variable projection (Golub and Pereyra 1973, simplified as by Kaufman 1975): the amplitudes follow
from the frequencies by linear least squares, which leaves Gauss-Newton equations in the frequencies
alone. They need nothing but inner products of waves and of their slopes.
"""

from math import ceil
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray

_RIDGE = 1e-9
"""Share of the weights' sum that keeps the equations regular where two lines have met."""
_FIRST_DAMPING = 1e-3


class Signals(NamedTuple):
    """What is fitted, zero where it is not observed."""

    samples: Array
    """(run, time, component)."""
    weight: Array
    """Of each epoch (run, time)."""

    def take(self, runs: IntArray | slice) -> "Signals":
        """Return some of the runs."""
        return Signals(self.samples[runs], self.weight[runs])

    @property
    def epochs(self) -> IntArray:
        """Return how many epochs are observed (run)."""
        return np.asarray(np.sum(self.weight > 0, axis=-1))

    @property
    def energy(self) -> Array:
        """Return the weighted sum of squares (run)."""
        return np.asarray(np.sum(self.samples**2 * self.weight[..., None], axis=(-2, -1)))


class LineFit(NamedTuple):
    """The best amplitudes at some frequencies, and the equations of the next step."""

    frequency: Array
    """(run, line), radians per epoch."""
    amplitude: Array
    """(run, 1 + 2 line, component): of the constant, the cosines, the sines."""
    cost: Array
    """Weighted sum of squares (run) that is left."""
    descent: Array
    """(run, line), of half the cost with the frequency."""
    curvature: Array
    """(run, line, line), of half the cost."""

    def take(self, runs: IntArray | BoolArray) -> "LineFit":
        """Return some of the runs."""
        return LineFit(*(field[runs] for field in self))


def lines_at(fit: LineFit, count: int) -> Array:
    """Return the fitted signals (run, time, component) at all `count` epochs."""
    signal: Array = _waves(fit.frequency, count) @ fit.amplitude
    return signal


def fit_lines(signals: Signals, frequency: Array) -> LineFit:
    """Return the least-squares fit at frequencies (run, line)."""
    waves = 1 + 2 * frequency.shape[-1]
    root = np.sqrt(signals.weight)[..., None]
    columns = _waves_and_slopes(frequency, signals.samples.shape[1]) * root
    samples = signals.samples * root
    wave, products = columns[..., :waves], _transposed(columns) @ columns
    normal, cross = products[:, :waves, :waves], products[:, :waves, waves:]
    normal += _RIDGE * np.sum(root**2, axis=1, keepdims=True) * np.eye(waves)
    amplitude = np.asarray(np.linalg.solve(normal, _transposed(wave) @ samples))
    residual = samples - wave @ amplitude
    projected = products[:, waves:, waves:] - _transposed(cross) @ np.linalg.solve(normal, cross)
    moving, pull = amplitude[:, 1:], _transposed(columns[..., waves:]) @ residual
    return LineFit(
        frequency=frequency,
        amplitude=amplitude,
        cost=np.sum(residual**2, axis=(-2, -1)),
        descent=_of_lines(np.sum(moving * pull, axis=-1), -1),
        curvature=_of_lines(_of_lines(projected * (moving @ _transposed(moving)), -1), -2),
    )


def refine_lines(
    signals: Signals, frequency: Array, iterations: int = 20, tolerance: float = 1e-3
) -> LineFit:
    """Return the fit of least cost at frequencies (run, line) near the given ones.

    Damped Gauss-Newton steps, none longer than half a resolution (pi over the number of epochs);
    a run is finished when its step is below `tolerance` times that.
    """
    longest = np.pi / signals.samples.shape[1]
    fit = fit_lines(signals, frequency.copy())
    damping = np.full(len(frequency), _FIRST_DAMPING)
    active = np.arange(len(frequency))
    for _ in range(iterations):
        now = fit.take(active)
        step = np.clip(_step(now, damping[active]), -longest, longest)
        trial = fit_lines(signals.take(active), now.frequency + step)
        better = trial.cost <= now.cost
        for kept, tried in zip(fit, trial):
            kept[active[better]] = tried[better]
        damping[active] *= np.where(better, 0.1, 10.0)
        active = active[np.abs(step).max(axis=-1) > tolerance * longest]
        if not active.size:
            break
    return fit


def _step(fit: LineFit, damping: Array) -> Array:
    """Solve the damped equations for the change (run, line) of the frequencies."""
    diagonal = np.einsum("rkk->rk", fit.curvature)
    added = damping[:, None] * diagonal + np.finfo(float).tiny
    damped = fit.curvature + added[..., None] * np.eye(diagonal.shape[-1])
    return np.asarray(np.linalg.solve(damped, fit.descent[..., None])[..., 0])


def _epochs(count: int) -> Array:
    """Epochs (time,) about the middle: there, amplitudes and frequencies are least correlated."""
    return np.arange(count, dtype=np.float64) - 0.5 * (count - 1)


def _waves_and_slopes(frequency: Array, count: int) -> Array:
    """Return `_waves`, and the derivatives of those that move (run, time, 1 + 4 line)."""
    lines, epochs = frequency.shape[-1], _epochs(count)[:, None]
    columns = np.empty((len(frequency), count, 1 + 4 * lines))
    wave, slope = np.split(columns, [1 + 2 * lines], axis=-1)
    wave[...] = _waves(frequency, count)
    np.multiply(wave[..., 1 + lines :], -epochs, out=slope[..., :lines])
    np.multiply(wave[..., 1 : 1 + lines], epochs, out=slope[..., lines:])
    return columns


def _waves(frequency: Array, count: int) -> Array:
    """Return constant, cosines and sines (run, time, 1 + 2 line) of angles that are added."""
    epochs, step = _epochs(count), ceil(count**0.5)
    coarse = np.exp(1j * epochs[::step, None] * frequency[:, None, :])
    fine = np.exp(1j * np.arange(step)[:, None] * frequency[:, None, :])
    turning = coarse[:, :, None] * fine[:, None]
    turning = turning.reshape(len(frequency), -1 if turning.size else count, frequency.shape[-1])
    turning = turning[:, :count]
    constant = np.ones((len(frequency), count, 1))
    return np.concatenate([constant, turning.real, turning.imag], axis=-1)


def _transposed(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)


def _of_lines(values: Array, axis: int) -> Array:
    """Add what belongs to the cosine and to the sine of each line, one after the other."""
    cosine, sine = np.split(values, 2, axis=axis)
    return np.asarray(cosine + sine)
