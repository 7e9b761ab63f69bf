"""How numbers lie in a file: as they are, or in compressed parts where that saves much.

Compression costs about thirty times the time of writing, so a dataset is compressed only if a part
of it shrinks to ``WORTH`` of its size: what is the same in all runs, mostly not observed, or not
kept. Parts without any number are not written at all; HDF5 fills them with NaN.
"""

import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Array

WORTH = 0.7
_LEVEL = 1
_SMALLEST, _PART = 2**13, 2**18
"""Bytes below which a dataset is left alone, and of a part: all runs of some epochs."""
_PARTS = 16
"""A dataset has as many parts at least, so that a single epoch does not need all of it."""


def create_numbers(file: Any, name: str, value: Array) -> Any:
    """Return a new dataset of an open file that holds ``value (run, ...)``."""
    parts = list(_parts(value))
    if len(parts) < 2 or not _worth(value[parts[len(parts) // 2]]):
        return file.create_dataset(name, data=value)
    dataset = file.create_dataset(
        name,
        value.shape,
        np.float64,
        chunks=value[parts[0]].shape,
        compression=_LEVEL,
        shuffle=True,
        fillvalue=np.nan,
    )
    for part in parts:
        if not np.isnan(value[part]).all():
            dataset[part] = value[part]
    return dataset


def _parts(value: Array) -> Iterator[tuple[slice, slice]]:
    """Yield what a dataset is cut into along its second axis, if it is long."""
    if value.ndim < 2 or value.nbytes < _SMALLEST:
        return
    length = value.shape[1]
    most = _PART * length // value.nbytes
    step = max(1, min(most, -(-length // _PARTS)))
    yield from ((slice(None), slice(first, first + step)) for first in range(0, length, step))


def _worth(part: NDArray[Any]) -> bool:
    """Return whether a part shrinks enough, its bytes in the order that HDF5 gives them."""
    shuffled = np.ascontiguousarray(part).view(np.uint8).reshape(-1, 8).T.tobytes()
    return len(zlib.compress(shuffled, _LEVEL)) <= WORTH * len(shuffled)
