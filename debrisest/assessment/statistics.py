"""Statistics of an error over a window and over runs.

Each statistic is a reduction over the window, which gives one figure per run, and one over runs.
``median`` is that of the per-run RMS, ``p50`` that of the per-run mean of the absolute value; the
``mean`` of an error with a sign is its bias, and leaves out epochs without a value.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray


class Statistic(NamedTuple):
    """``per_run`` reduces (run, time) to (run,), ``over_runs`` reduces (..., run) to (...)."""

    per_run: Callable[[Array], Array]
    over_runs: Callable[[Array], Array]


def _rms(values: Array) -> Array:
    with np.errstate(over="ignore"):
        return np.asarray(np.sqrt(np.mean(values**2, axis=-1)))


def _mean(values: Array) -> Array:
    return np.asarray(np.mean(values, axis=-1))


def _mean_of_known(values: Array) -> Array:
    """Mean over the epochs that have a value; NaN where none has."""
    known = np.isfinite(values)
    total = np.where(known, values, 0.0).sum(axis=-1)
    with np.errstate(invalid="ignore"):
        return np.asarray(total / known.sum(axis=-1))


def _mean_absolute(values: Array) -> Array:
    return np.asarray(np.mean(np.abs(values), axis=-1))


def _largest(values: Array) -> Array:
    return np.asarray(np.max(values, axis=-1))


def _percentile(share: float) -> Callable[[Array], Array]:
    return lambda values: np.percentile(values, share, axis=-1)


STATISTICS: dict[str, Statistic] = {
    "rmse": Statistic(_rms, _mean),
    "rms": Statistic(_rms, _rms),
    "median": Statistic(_rms, _percentile(50)),
    "p50": Statistic(_mean_absolute, _percentile(50)),
    "p70": Statistic(_mean_absolute, _percentile(70)),
    "p90": Statistic(_mean_absolute, _percentile(90)),
    "p100": Statistic(_mean_absolute, _percentile(100)),
    "mean": Statistic(_mean_of_known, _mean),
    "value": Statistic(_mean, _mean),
    "share": Statistic(_mean, _mean),
    "ever": Statistic(_largest, _mean),
}


def rms_where(chosen: BoolArray, error: Array) -> Array:
    """Return the root mean square (run,) over the chosen epochs (run, time), NaN where is none."""
    count = chosen.sum(axis=-1)
    total = np.sum(error**2, axis=-1, where=chosen)
    return np.asarray(np.sqrt(total / np.where(count > 0, count, np.nan)))


def per_dimension(square: Array, dof: Array) -> Array:
    """Return a normalised square over its degrees of freedom, NaN where there is none."""
    counted = np.where(dof > 0, dof, np.nan)
    return np.asarray(square / counted)


def window_mask(times: Array, window: tuple[float, float]) -> BoolArray:
    """Return which epochs (time,) lie in ``[start, end)``; an instant takes the nearest epoch."""
    start, end = window
    if start == end:
        return np.asarray(np.arange(len(times)) == np.argmin(np.abs(times - start)))
    return (times >= start) & (times < end)


def per_run(name: str, values: Array, inside: BoolArray) -> Array:
    """Return one figure per run (run,) of an error (run, time) over a window, or of (run,)."""
    series = values[:, inside] if values.ndim == 2 else values[:, None]
    return STATISTICS[name].per_run(series)
