"""The runs of several files as if they were of one."""

from collections.abc import Iterable, Sequence
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Data
from debrisest.vocabulary import has_runs


def joined(parts: Iterable[Data], runs: Sequence[int]) -> Data:
    """Return all runs of ``parts``, in this order; ``runs`` says how many each of them has.

    One part is held at a time. Where one has not got a dataset, since all its runs failed, or its
    axes are shorter than those of others, there is NaN (in texts, nothing).
    """
    if len(runs) == 1:
        return next(iter(parts))
    whole: Data = {}
    for part, first in zip(parts, accumulate(runs, initial=0)):
        for name, values in part.items():
            if has_runs(name):
                whole[name] = _room(whole.get(name, values[:0]), values, sum(runs))
                inside = (slice(first, first + len(values)), *map(slice, values.shape[1:]))
                whole[name][inside] = values
            else:
                whole.setdefault(name, values)
    return whole


def _room(found: NDArray[Any], values: NDArray[Any], runs: int) -> NDArray[Any]:
    """Return what was found, with room for all runs and for values like these."""
    axes = np.maximum(found.shape[1:], values.shape[1:]).astype(int).tolist()
    kind = np.result_type(found, values)
    if found.shape == (runs, *axes) and found.dtype == kind:
        return found
    nothing = {"f": np.nan, "U": ""}.get(kind.kind, 0)
    larger = np.full((runs, *axes), nothing, kind)
    larger[tuple(map(slice, found.shape))] = found
    return larger
