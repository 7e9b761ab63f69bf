"""Starts of the descent, best first."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.batch.arc import Arc
from debrisest.batch.descent import Prior
from debrisest.batch.local_rates import Local
from debrisest.batch.momentum_start import inertia_start
from debrisest.dynamics import log_inertia

_MOST_WINDOWS = 4
_GUESSES = np.array(
    [[0.004, 0.002], [0.05, 0.03], [-0.3, -0.2], [0.3, 0.2], [-0.2, 0.3]]
)  # of the first two moments, where the momentum says nothing
_SIGMA = 0.2  # of a guess's log-ratios, half the distance to others


class Start(NamedTuple):
    """Where a descent may begin."""

    arc: Arc
    held: Prior
    """The inertia as long as the window is too short to show it: one that is let go at once is
    forgotten in the first window, and all starts are the same."""


def starts(local: Local) -> Iterator[Start]:
    """Yield arcs about the middle of the best windows: inertia by momentum first, then guesses."""
    best = best_windows(local)
    inertia = inertia_start(local)
    for window in best:
        yield Start(arc_of(local, window, inertia.centre), inertia)
    for guess in inertia_guesses():
        for window in best[:2]:
            yield Start(arc_of(local, window, guess), Prior(guess, np.eye(5) / _SIGMA**2))


def inertia_guesses() -> Array:
    """Return log-ratios (guess, 5) of bodies of several shapes."""
    first, second = _GUESSES.T
    moments = np.stack([1.0 + first, 1.0 - first + second, 1.0 - second], axis=-1)
    return log_inertia.log_ratios(moments[..., None] * np.eye(3))


def best_windows(local: Local) -> IntArray:
    """Return up to four windows with the best rates, far from each other."""
    speed2 = np.maximum(np.sum(local.rate**2, axis=-1), 1e-300)
    spread = np.trace(local.covariance, axis1=-2, axis2=-1) / speed2
    chosen: list[int] = []
    for window in np.argsort(spread):
        apart = np.abs(local.time[chosen] - local.time[window])
        if apart.min(initial=np.inf) >= 4.0 * local.half:
            chosen.append(int(window))
    return np.array(chosen[:_MOST_WINDOWS])


def arc_of(local: Local, window: int, inertia: Array) -> Arc:
    """Return an arc about the middle of a window, with log-ratios (5) of the inertia."""
    return Arc(float(local.time[window]), local.q[window], local.rate[window], inertia)
