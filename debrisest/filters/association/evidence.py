"""What the innovations of a track say against its model, gathered as it goes.

A filter that forgets follows even what its model does not have; its innovations have the right
size, and yet they go with what would be seen. For each doubted number that is the derivative of
the prediction by it, through all updates before, and for accelerations larger than stated what a
filter that expects them predicts otherwise. Times the whitened innovation it is Rao's score, or its
like for a distant alternative. If the model is right each product has the mean zero, whatever went
before, so that their sum over its sigma is normal.
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.association.update import Correction
from debrisest.filters.linear_algebra import solve
from debrisest.filters.scan_model import ScanModel

_RESTLESS = 10.0
"""Process noise of the other filter in units of the model's own."""


class Pull(NamedTuple):
    """How the estimate of the target would be another one if the model were."""

    state: Array
    """Derivatives of the state by the doubts, and behind them the difference of the state by more
    process noise, (run, n, doubt + 1)."""
    spread: Array
    """Covariance with more process noise, (run, n, n)."""


class Scores(NamedTuple):
    """Sums over the epochs, (run, doubt + 1) each, of products and of what they are made of."""

    score: Array
    square: Array
    information: Array

    def add(self, runs: IntArray, score: Array, information: Array) -> None:
        """Add what an update of some runs shows, in place."""
        self.score[runs] += score
        self.square[runs] += score**2
        self.information[runs] += information


def nothing_yet(model: ScanModel, state: Array, covariance: Array) -> tuple[Pull, Scores]:
    """Return where all begins, for states (run, n)."""
    (runs, n), numbers = state.shape, len(model.doubts) + 1
    sums = [np.zeros((runs, numbers)) for _ in Scores._fields]
    return Pull(np.zeros((runs, n, numbers)), covariance), Scores(*sums)


def score_sigma(square: Array, information: Array) -> Array:
    """Return the sigma of scores: by their products or, if that is less, as the filter states it.

    The latter is too large for detections that may be clutter, the former for few large products.
    """
    return np.minimum(square, information) ** 0.5


def predicted(pull: Pull, transition: Array, noise: Array) -> Pull:
    """Return it an epoch later."""
    spread = transition @ pull.spread @ np.swapaxes(transition, -2, -1)
    return Pull(transition @ pull.state, spread + _RESTLESS**2 * noise)


def corrected(pull: Pull, made: Correction, doubted: Array) -> tuple[Pull, Array, Array]:
    """Return it after an update of the target, and products and information (run, doubt + 1).

    ``doubted (run, sensor, d, doubt)`` is the derivative of the points that are shown.
    """
    h, total, gain = made.shown[:, 0], made.total[:, 0], made.gain[:, 0]
    trusted, innovation = made.trusted[:, 0, :, None], made.innovation[:, 0, :, None]
    change = h @ pull.state
    change[..., :-1] += doubted.reshape(*change.shape[:2], -1)
    white = solve(total, np.concatenate([innovation, change], axis=-1))
    expected = trusted * change
    spread, other = _restless(pull.spread, h, total - made.own[:, 0], trusted)
    moved = np.swapaxes(gain, -2, -1) @ expected
    moved[..., -1:] = np.swapaxes(other, -2, -1) @ expected[..., -1:]
    moved[..., -1:] -= np.swapaxes(other - gain, -2, -1) @ innovation
    score = (change * white[..., :1]).sum(-2)
    return Pull(pull.state - moved, spread), score, (expected * white[..., 1:]).sum(-2)


def _restless(spread: Array, h: Array, noise: Array, trusted: Array) -> tuple[Array, Array]:
    """Covariance after the update of a filter with more process noise, and its gain, transposed."""
    cross = h @ spread
    gain = solve(cross @ np.swapaxes(h, -2, -1) + noise, cross)
    kept = np.eye(h.shape[-1]) - np.swapaxes(gain, -2, -1) @ (trusted * h)
    added = np.swapaxes(gain, -2, -1) @ (trusted * noise @ gain)
    return kept @ spread @ np.swapaxes(kept, -2, -1) + added, gain
