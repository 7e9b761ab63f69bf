"""Epochs of an even grid that a file leaves out, since nothing was seen then."""

import numpy as np

from debrisest.arrays import Array

_OFF = 0.01
"""Of a step: how far from the grid an epoch may be."""
_MOST = 2.0
"""Epochs of the grid for each one that is there; more make no grid with gaps."""


def with_gaps(times: Array) -> Array:
    """Return times ``(time,)`` with those of the grid between them, if they are on an even grid.

    Signals over all epochs, such as spectra, need these; other times are returned as they are.
    """
    steps = np.diff(times)
    counts = np.round(steps / np.median(steps))
    grid = (times[-1] - times[0]) / max(counts.sum(), 1.0)
    even = (counts >= 1).all() and (np.abs(steps - counts * grid) <= _OFF * grid).all()
    if not even or counts.sum() + 1 > _MOST * len(times):
        return times
    number = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    epochs = np.interp(np.arange(number[-1] + 1), number, times)
    epochs[number] = times
    return np.asarray(epochs)


def on_epochs(values: Array, times: Array, epochs: Array) -> Array:
    """Return ``values (time, ...)`` at ``epochs``, which hold all ``times``; NaN at the others."""
    result = np.full((len(epochs), *values.shape[1:]), np.nan)
    result[np.searchsorted(epochs, times)] = values
    return result
