"""Repeated Gauss-Newton steps of an update, until no run moves any more."""

from collections.abc import Callable

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray


def iterate(
    correction: Array,
    again: Callable[[IntArray], None],
    moved: Callable[[Array], BoolArray],
    iterations: int,
) -> IntArray:
    """Repeat a first step, whose `correction` (run, n_e) of the prior is there; steps (run,).

    `again(runs)` takes a further step of some runs and changes the correction in place;
    `moved(before)` says which runs the last step has moved far, from another correction.
    A run that has come to rest stays there.
    """
    count, before = np.ones(len(correction), dtype=np.int64), np.zeros_like(correction)
    moving = np.ones(len(correction), dtype=np.bool_)
    for _ in range(iterations - 1):
        moving &= moved(before)
        runs = np.flatnonzero(moving)
        if len(runs) == 0:
            break
        before = correction.copy()
        again(runs)
        count[runs] += 1
    return count
