"""The runs of several files as if they were of one."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Data
from debrisest.vocabulary import has_runs


def joined(parts: Sequence[Data]) -> Data:
    """Return all runs of ``parts``, in this order.

    Where a part has not got a dataset, since all its runs failed, or its axes are shorter than
    those of others, there is NaN (in texts, nothing).
    """
    names = dict.fromkeys(name for part in parts for name in part)
    return {name: _joined(name, parts) for name in names}


def _joined(name: str, parts: Sequence[Data]) -> NDArray[Any]:
    given = [part[name] for part in parts if name in part]
    if not has_runs(name) or len(parts) == 1:
        return given[0]
    shape = np.max([values.shape[1:] for values in given], axis=0).astype(int)
    return np.concatenate(
        [_padded(part.get(name, given[0][:0]), len(part["run"]), shape) for part in parts]
    )


def _padded(values: NDArray[Any], runs: int, shape: NDArray[np.int64]) -> NDArray[Any]:
    wanted = (runs, *shape.tolist())
    if values.shape == wanted:
        return values
    padded = np.full(wanted, "" if values.dtype.kind in "US" else np.nan, values.dtype)
    padded[tuple(map(slice, values.shape))] = values
    return padded
