"""What the innovations of a track say against its model, gathered as it goes.

A filter that forgets follows even what its model does not have; its innovations have the right
size, and yet they go with what would be seen. For each doubted number that is the derivative of
the prediction by it, through all updates before. Times the whitened innovation it is Rao's score:
if the model is right each product has the mean zero, whatever went before, so that their sum over
its sigma is normal. Accelerations larger than stated are not a number but a noise: these are told
by the likelihood of filters that expect them (`restless`).
"""

from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.association import restless
from debrisest.filters.association.update import Correction
from debrisest.filters.linear_algebra import solve
from debrisest.filters.scan_model import ScanModel

_NOTHING = 1e-300


class Beside(NamedTuple):
    """How the estimate of the target would be another one if the model were."""

    pull: Array
    """Derivatives of the state by the doubts, (run, n, doubt)."""
    bank: restless.Bank


class Evidence(NamedTuple):
    """What updates show, or sums of it over the epochs."""

    score: Array
    """Products of innovations and what they would be for each doubt, (run, doubt)."""
    square: Array
    """Products of the scores of an epoch, (run, doubt, doubt)."""
    information: Array
    """What the filter states for the sum of these."""
    likelihood: Array
    """Logarithmic, of each filter of the bank, (run, filter)."""

    def plus(self, other: "Evidence") -> "Evidence":
        """Add them."""
        return Evidence(*(mine + more for mine, more in zip(self, other)))

    def add(self, runs: IntArray, shown: "Evidence") -> None:
        """Add what an epoch shows of some runs, whose products count as one, in place."""
        square = shown.score[:, :, None] * shown.score[:, None]
        for total, values in zip(self, shown._replace(square=square)):
            total[runs] += values


def nothing_yet(model: ScanModel, state: Array, covariance: Array) -> tuple[Beside, Evidence]:
    """Return where all begins, for states (run, n)."""
    (runs, n), doubts = state.shape, len(model.doubts)
    beside = Beside(np.zeros((runs, n, doubts)), restless.begun(covariance))
    return beside, no_evidence(runs, doubts)


def no_evidence(runs: int, doubts: int) -> Evidence:
    """Return no evidence."""
    square, information = np.zeros((2, runs, doubts, doubts))
    likelihood = np.zeros((runs, len(restless.FACTORS)))
    return Evidence(np.zeros((runs, doubts)), square, information, likelihood)


def score_sigma(square: Array, information: Array) -> Array:
    """Return the sigma of scores: by their products or, if that is less, as the filter states it.

    The latter is too large for detections that may be clutter, the former for few large products.
    """
    return _root(np.minimum(square, information))


def score_correlation(information: Array) -> Array:
    """Return how scores are correlated (run, doubt, doubt), as the filter states it."""
    sigma = _root(information)
    return information / (sigma[:, :, None] * sigma[:, None])


def _root(square: Array) -> Array:
    """Square root of the diagonal, not zero where nothing tells of a doubt, whose score is zero."""
    return np.asarray(np.maximum(np.diagonal(square, 0, -2, -1), _NOTHING) ** 0.5)


def predicted(beside: Beside, transition: Array, noise: Array) -> Beside:
    """Return it an epoch later."""
    return Beside(transition @ beside.pull, restless.predicted(beside.bank, transition, noise))


def corrected(beside: Beside, made: Correction, doubted: Array) -> tuple[Beside, Evidence]:
    """Return it after an update of the target, and what this shows.

    ``doubted (run, sensor, d, doubt)`` is the derivative of the points that are shown.
    """
    h, trusted = made.shown[:, 0], made.trusted[:, 0, :, None]
    change = h @ beside.pull + doubted.reshape(*h.shape[:2], -1)
    innovation = made.innovation[:, 0, :, None]
    white = solve(made.total[:, 0], np.concatenate([innovation, change], axis=-1))
    expected = trusted * change
    pull = beside.pull - np.swapaxes(made.gain[:, 0], -2, -1) @ expected
    score = (change * white[..., :1]).sum(-2)
    bank, likelihood = restless.corrected(beside.bank, made)
    information = np.swapaxes(expected, -2, -1) @ white[..., 1:]
    return Beside(pull, bank), Evidence(score, 0.0 * information, information, likelihood)
