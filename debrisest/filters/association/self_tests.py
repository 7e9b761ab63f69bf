"""What the association filters say of themselves, beside the tests of any problem."""

import numpy as np

from debrisest.arrays import Array
from debrisest.filters.self_test import SIGMAS
from debrisest.filters.verdict import SelfTest

_RATIO, _MOST = 10.0, 700.0
"""Of likelihoods, from which on there is doubt; and the largest logarithm that is told."""
_TOLD = 0.64
"""Part of the stated information that views must hold, so that errors are 1.25 times as large."""
_CROWDED = 0.6
"""Share of near pairs where clutter is dense in the middle; of pieces that stay it is 0.73."""


def missed_test(matched: Array, looked: Array, expected: float) -> SelfTest:
    """Test the number of views (run,) in which the target's gate was empty, of those `looked` at.

    ``expected`` is the probability that its detection is there and within the gate.
    """
    views = np.maximum(looked, 1)
    return SelfTest(
        1.0 - matched / views,
        1.0 - expected + SIGMAS * np.sqrt(np.maximum(expected * (1.0 - expected), 1e-4) / views),
        "in a share of {value} of the views nothing lay where the target was expected, {limit} at "
        "most by chance: the track is lost, or the noise larger than given",
    )


def crowd_test(mistaken: Array, looked: Array) -> SelfTest:
    """Test how often (run,) a filter that takes the nearest point for certain is wrong in that.

    ``mistaken`` sums the probabilities of it by the distances of all points within the gate. Points
    that are not the target's do not move with it: views of which a share w is wrong tell
    (1 - w)^2 of what they are taken to tell.
    """
    return SelfTest(
        mistaken / np.maximum(looked, 1),
        1.0 - _TOLD**0.5,
        "in a share of {value} of the views the nearest point, which was taken for certain, is "
        "likely another's, and above {limit} that makes errors larger; weigh the points instead",
    )


def agitation_test(log_ratio: Array) -> SelfTest:
    """Test the ratio of likelihoods (run,) of a model with more process noise and the model's own.

    Its mean is one if the latter is right; that it is `_RATIO` is far less likely than 1 / `_RATIO`
    where what the noise does can be seen a few times only, 0.007 as counted.
    """
    return SelfTest(
        np.exp(np.minimum(log_ratio, _MOST)),
        _RATIO,
        "what is seen is {value} times as likely ({limit} by chance at most) if accelerations are "
        "larger than stated: something moves or errs in a way that the model does not have",
    )


def companion_test(near: Array, ring: Array) -> SelfTest:
    """Test whether what is beside the target stays: pairs (run,) of following frames that are near
    each other, and those in a ring of the same area, where new clutter is as frequent."""
    pairs = np.maximum(near + ring, 1)
    return SelfTest(
        near / pairs,
        _CROWDED + SIGMAS * np.sqrt(0.25 / pairs),
        "points beside the target stay where they are from frame to frame ({value} of the close "
        "pairs, {limit} at most by chance): they are no clutter but pieces that fly along, one of "
        "which may be followed instead; track them too",
    )
