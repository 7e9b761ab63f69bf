"""When of two solutions of the same data one is given up, and when the data decide."""

import numpy as np

from debrisest.arrays import Array

GIVEN_UP = 100.0
"""Excess of cost beyond the other solution's at which one is given up early."""
DECISIVE = 20.0
"""Difference of the costs of two solutions, twice the logarithm of their odds, that decides."""


def squared_distance(offset: Array, information: Array) -> Array:
    """Square (run,) of the ``offset (run, n)`` of two solutions in sigmas: small for the same."""
    return np.asarray((offset[:, None] @ information @ offset[..., None])[:, 0, 0])
