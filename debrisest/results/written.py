"""Datasets as an HDF5 file in memory, by the calls below h5py's objects: a file has many of them.

They are flat float64 (names are text; images uint8) with units and dimension scales, compressed
where that saves much, so that h5py and xarray (``engine="h5netcdf"``) read them without this
package.
"""

from collections.abc import Mapping
from typing import Any

import h5py
import numpy as np
from h5py import h5a, h5ds, h5s, h5t

from debrisest.arrays import Data
from debrisest.results.image import NO_COORDINATE, as_stored, lengths
from debrisest.results.packed import create
from debrisest.vocabulary import COORDINATES, VOCABULARY

_STRING = h5py.string_dtype()
_SCALAR = h5s.create(h5s.SCALAR)


def image_of(data: Data, attributes: Mapping[str, Any], frames: Mapping[str, str]) -> bytes:
    """Return an HDF5 file; ``frames`` becomes the attribute ``frame`` of the datasets it names."""
    options = {"driver": "core", "backing_store": False, "libver": "latest", "track_order": True}
    with h5py.File("image", "w", **options) as file:
        for name, value in attributes.items():
            _tell(file.id, name, value)
        written = _write_data(file.id, as_stored(data))
        for name in written.keys() & frames.keys():
            _tell(written[name], "frame", frames[name])
        file.flush()
        return bytes(file.id.get_file_image())


def _write_data(file: Any, data: Data) -> dict[str, Any]:
    """Write datasets, coordinates first, and return them with those that an axis without has."""
    written: dict[str, Any] = {}
    for name in sorted(data, key=lambda name: name not in COORDINATES):
        written[name] = dataset = create(file, name, _as_written(data[name]))
        _tell(dataset, "units", VOCABULARY[name].unit)
        _tell(dataset, "long_name", VOCABULARY[name].long_name)
        if name in COORDINATES:
            h5ds.set_scale(dataset, name.encode())
            continue
        for axis, (label, length) in enumerate(lengths(name, data[name].shape).items()):
            if label not in written:
                written[label] = create(file, label, np.zeros(length))
                h5ds.set_scale(written[label], NO_COORDINATE + f"{length:10d}".encode())
            h5ds.attach_scale(dataset, written[label], axis)
    return written


def _tell(where: Any, name: str, value: Any) -> None:
    """Give a dataset or the file an attribute: a text or a number."""
    told = np.array(value, _STRING if isinstance(value, str) else None)
    h5a.create(where, name.encode(), h5t.py_create(told.dtype, logical=True), _SCALAR).write(told)


def _as_written(value: Any) -> Any:
    """Return texts as HDF5 takes them, numbers as they are."""
    return np.array(value.tolist(), _STRING) if value.dtype.kind == "U" else value
