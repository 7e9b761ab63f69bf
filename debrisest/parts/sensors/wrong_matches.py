"""Points that were taken for others."""

import numpy as np

from debrisest.arrays import Array
from debrisest.draws import Draws, Stream

_SHIFTS = (1.0, 5.0)
"""By how much a wrong match that is no swap is off, m."""


def with_wrong_matches(points: Array, share: float, draws: Draws) -> Array:
    """Return points (run, time, feature, 3) of which a share is wrong.

    Half of them are off by 1 to 5 m, half exchanged with the next feature, where that is seen.
    """
    chance, size = np.moveaxis(draws.uniform(Stream.CLUTTER, (2, *points.shape[1:-1])), 1, 0)
    way = draws.normal(Stream.CLUTTER, points.shape[1:])
    length = _SHIFTS[0] + (_SHIFTS[1] - _SHIFTS[0]) * size
    shift = (length / np.linalg.norm(way, axis=-1))[..., None] * way
    wrong = np.where((chance < 0.5 * share)[..., None], points + shift, points)
    swapped = (chance >= 0.5 * share) & (chance < 0.75 * share)
    seen, features = np.isfinite(points[..., 0]), points.shape[-2]
    for one in range(features):
        other = (one + 1) % features
        both = swapped[..., one] & seen[..., one] & seen[..., other]
        first, second = wrong[both, one].copy(), wrong[both, other].copy()
        wrong[both, one], wrong[both, other] = second, first
    return wrong
