"""Whether what is beside a target stays there: clutter is new in every frame, pieces are not."""

import numpy as np

from debrisest.arrays import Array, IntArray
from debrisest.filters.association.update import Judged
from debrisest.filters.linear_algebra import solve

CLAIMED = 0.5
NEAR = 2.0
"""Squared distance of a pair, in units of the noise of a difference, that 63 % of the pairs of one
piece are within; of two in a smooth crowd, as many lie between once and twice it."""


def unclaimed(innovation: Array, judged: Judged) -> Array:
    """Detections beside the target (run, sensor, detection, d), NaN what is likely a track's."""
    claimed = np.asarray((judged.probability > CLAIMED).any(1))
    return np.where(claimed[..., None], np.nan, innovation[:, 0])


def pairs(before: Array, now: Array, noise: Array) -> tuple[IntArray, IntArray]:
    """Count the pairs (run,) of two epochs that are near each other, and in a ring of equal area.

    Both (run, sensor, detection, d), beside the target as it is expected.
    """
    apart = now[..., :, None, :] - before[..., None, :, :]
    square = (apart * (apart @ solve(2.0 * noise, np.eye(len(noise))))).sum(-1)
    return tuple(
        ((least <= square) & (square < least + NEAR)).sum((1, 2, 3)) for least in (0.0, NEAR)
    )
