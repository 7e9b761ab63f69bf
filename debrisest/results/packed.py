"""How numbers lie in a file: as they are, or in compressed parts where that saves much.

Compression costs about thirty times the time of writing, so a dataset is compressed only if a part
of it shrinks to ``WORTH`` of its size: what is the same in all runs, mostly not observed, or not
kept. Parts without any number are not written at all; HDF5 fills them with NaN.
"""

import zlib
from collections.abc import Iterator
from typing import Any

import numpy as np
from h5py import h5d, h5p, h5s, h5t
from numpy.typing import NDArray

from debrisest.arrays import Array

WORTH = 0.7
_LEVEL = 1
_SMALLEST, _PART = 2**13, 2**18
"""Bytes below which a dataset is left alone, and of a part: all runs of some epochs."""
_PARTS = 16
"""A dataset has as many parts at least, so that a single epoch does not need all of it."""


def create(file: Any, name: str, value: NDArray[Any]) -> h5d.DatasetID:
    """Return a new dataset of an open file: of numbers ``(run, ...)``, images or texts."""
    properties = h5p.create(h5p.DATASET_CREATE)
    properties.set_obj_track_times(False)
    parts = list(_parts(value)) if value.dtype == np.float64 else []
    if len(parts) > 1 and _worth(value[parts[len(parts) // 2]]):
        properties.set_chunk(value[parts[0]].shape)
        properties.set_fill_value(np.array(np.nan))
        properties.set_shuffle()
        properties.set_deflate(_LEVEL)
        filled = [part for part in parts if not np.isnan(value[part]).all()]
    else:
        filled = parts = []
    if value.dtype == np.uint8:
        properties.set_chunk((1,) * (value.ndim - 2) + value.shape[-2:])
        properties.set_deflate(_LEVEL)
    kind, space = h5t.py_create(value.dtype, logical=True), h5s.create_simple(value.shape)
    dataset = h5d.create(file, name.encode(), kind, space, properties)
    if len(filled) == len(parts):
        dataset.write(h5s.ALL, h5s.ALL, value)
        return dataset
    for _, epochs in filled:
        part = np.ascontiguousarray(value[:, epochs])
        space.select_hyperslab((0, epochs.start, *(0 for _ in part.shape[2:])), part.shape)
        dataset.write(h5s.create_simple(part.shape), space, part)
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
