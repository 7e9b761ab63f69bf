"""Which estimated principal axis is which true one: the 24 proper relabelings.

A filter that estimates the rate in principal axes knows these axes only up to a permutation with
signs, since every labelling of the axes describes the same motion.
"""

from itertools import permutations, product

import numpy as np

from debrisest.arrays import Array


def _proper_relabelings() -> Array:
    signed = [
        np.eye(3)[list(order)] * np.array(signs)[:, None]
        for order in permutations(range(3))
        for signs in product((1.0, -1.0), repeat=3)
    ]
    return np.array([matrix for matrix in signed if np.linalg.det(matrix) > 0])


RELABELINGS = _proper_relabelings()
"""All signed permutations (24, 3, 3) that are rotations."""


def best_relabeling(estimated: Array, true: Array) -> Array:
    """Return the relabeling (run, 3, 3) of each run that fits the true rates best.

    ``estimated`` and ``true`` are rates (run, time, 3) over the scored window; the relabeling M
    minimises the sum of ``|M estimated - true|^2``. A run that is not finite keeps its labels.
    """
    correlation = np.swapaxes(true, -1, -2) @ estimated
    fit = np.sum(RELABELINGS * correlation[:, None], axis=(-2, -1))
    best = RELABELINGS[np.argmax(np.nan_to_num(fit, nan=-np.inf), axis=-1)]
    return np.where(np.isfinite(fit).all(axis=-1)[:, None, None], best, np.eye(3))
