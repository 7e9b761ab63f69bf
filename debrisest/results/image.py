"""Datasets of an HDF5 file in memory, looked at before they are taken for those of a step."""

from collections.abc import Container, Mapping
from io import BytesIO
from typing import Any, NamedTuple

import h5py
import numpy as np
from h5py import h5a, h5d, h5l, h5o, h5s
from numpy.typing import NDArray

from debrisest.arrays import Data
from debrisest.results.told import require_as_told
from debrisest.vocabulary import AXIS_LENGTH, COORDINATES, VOCABULARY, axes_of, has_runs

_NUMBERS = (np.float64, np.uint8)
_UNIT = np.dtype(object, metadata={"vlen": str})
NO_COORDINATE = b"This is a netCDF dimension but not a netCDF variable."


class _Dataset(NamedTuple):
    """A dataset, and what HDF5 takes long to tell."""

    id: Any
    dtype: Any
    shape: tuple[int, ...]


def as_stored(data: Data) -> Data:
    """Return datasets as a file gives them back: texts, float64 or uint8, in one piece."""
    return {name: _as_stored(value) for name, value in data.items()}


def opened(image: bytes) -> Any:
    """Return an image as an open file of h5py."""
    return h5py.File(BytesIO(image), "r")


def check(image: bytes, attributes: Mapping[str, Any]) -> None:
    """Raise ValueError for a dataset that is not as the vocabulary and the attributes have it."""
    with opened(image) as file:
        for name in file:
            _dataset(file, name)
        _datasets(file, attributes, VOCABULARY)


def data_of(
    file: Any,
    attributes: Mapping[str, Any],
    names: Container[str],
    first: int = 0,
    end: int | None = None,
) -> Data:
    """Return those of the named datasets that are there, of the runs ``first`` up to ``end``.

    Raises ValueError as ``check`` does.
    """
    found = _datasets(file, attributes, names)
    return {
        name: _values(dataset, slice(first, end)) if has_runs(name) else _values(dataset)
        for name, dataset in found.items()
    }


def frames_of(file: Any) -> dict[str, str]:
    """Return the axes and origin of those datasets that say it."""
    said = ((name, dataset.attrs.get("frame")) for name, dataset in file.items())
    return {name: str(frame) for name, frame in said if frame is not None}


def _datasets(
    file: Any, attributes: Mapping[str, Any], names: Container[str]
) -> dict[str, _Dataset]:
    """Return the named datasets, or raise ValueError where they are not those that are told."""
    found = {name: _dataset(file, name) for name in file if name in names}
    there = {name: dataset for name, dataset in found.items() if dataset is not None}
    require_as_told(attributes, there, names, _values)
    return there


def _dataset(file: Any, name: str) -> _Dataset | None:
    """Return a dataset that the vocabulary has; None for others, and for the length of an axis.

    Raises ValueError unless it lies in the file itself and has its axes, type and unit.
    """
    is_own = file.id.links.get_info(name.encode()).type == h5l.TYPE_HARD
    dataset = h5o.open(file.id, name.encode()) if is_own else None
    if not isinstance(dataset, h5d.DatasetID) or _is_elsewhere(dataset.get_create_plist()):
        raise ValueError(f"{name} is no dataset of this file")
    if name not in VOCABULARY or (name in COORDINATES and _is_length(dataset)):
        return None
    found = _Dataset(dataset, dataset.dtype, dataset.shape)
    if not (found.dtype in _NUMBERS or h5py.check_string_dtype(found.dtype) is not None):
        raise ValueError(f"{name} is of the type {found.dtype}")
    h5a.open(dataset, b"units").read(unit := np.empty((), _UNIT))
    if unit.item() != VOCABULARY[name].unit.encode():
        raise ValueError(f"{name} is not in {VOCABULARY[name].unit}")
    lengths(name, found.shape)
    return found


def lengths(name: str, shape: tuple[int, ...]) -> dict[str, int]:
    """Return the length of each axis of a dataset, or raise ValueError for one it cannot have."""
    lengths = dict(zip(axes_of(name, len(shape)), shape))
    for axis, length in lengths.items():
        if AXIS_LENGTH.get(axis, length) != length:
            raise ValueError(f"{name} has {length} values along {axis}")
    return lengths


def _is_elsewhere(properties: Any) -> bool:
    return bool(properties.get_layout() == h5d.VIRTUAL or properties.get_external_count())


def _is_length(scale: Any) -> bool:
    if not h5a.exists(scale, b"NAME"):
        return False
    name = h5a.open(scale, b"NAME")
    name.read(text := np.empty(name.shape, name.dtype))
    return bool(text.item().startswith(NO_COORDINATE))


def _values(dataset: _Dataset, part: slice = slice(None)) -> NDArray[Any]:
    """Return a dataset, or a part along its first axis."""
    first, end, _ = part.indices(*dataset.shape[:1])
    value = np.empty((max(0, end - first), *dataset.shape[1:]), dataset.dtype)
    if value.shape == dataset.shape:
        dataset.id.read(h5s.ALL, h5s.ALL, value)
    else:
        space = dataset.id.get_space()
        space.select_hyperslab((first, *(0 for _ in value.shape[1:])), value.shape)
        dataset.id.read(h5s.create_simple(value.shape), space, value)
    return np.array([text.decode() for text in value]) if value.dtype.kind == "O" else value


def _as_stored(value: Any) -> Any:
    if value.dtype.kind in "US":
        return np.array(value.tolist(), dtype=str)
    return np.ascontiguousarray(value, value.dtype if value.dtype == np.uint8 else np.float64)
