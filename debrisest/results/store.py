"""HDF5 checkpoints: one file per stage and chunk of runs, whole or not there at all.

A file is written under a temporary name, synchronised, and renamed. Metadata and data carry
checksums. Datasets are flat float64 (names are text) with units and dimension scales, so that
h5py and xarray (``engine="h5netcdf"``) read them without this package.
"""

import json
from collections.abc import Container, Mapping
from datetime import UTC, datetime
from enum import Enum
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from debrisest.arrays import Data
from debrisest.files import replacing
from debrisest.vocabulary import AXIS_LENGTH, COORDINATES, VOCABULARY, axes_of, has_runs

FORMAT = "debrisest checkpoint"
SCHEMA_VERSION = 2
_NO_COORDINATE = "This is a netCDF dimension but not a netCDF variable."
_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


class Condition(Enum):
    """What a path holds, as words that follow «the file is»."""

    WHOLE = "whole"
    MISSING = "missing"
    DAMAGED = "truncated or damaged"
    OTHER_VERSION = "of another version of debrisest"
    FOREIGN = "not a checkpoint of debrisest"


class Checkpoint(NamedTuple):
    """What is known of a file without using its data."""

    condition: Condition
    attributes: dict[str, Any] = {}


def write(
    path: Path, data: Data, attributes: dict[str, Any], frames: Mapping[str, str] | None = None
) -> None:
    """Write a checkpoint in one step: afterwards it is there and whole, or as it was before.

    ``frames`` becomes the attribute ``frame`` of the datasets it names.
    """
    with (
        replacing(path) as temporary,
        h5py.File(temporary, "w", libver="latest", track_order=True) as file,
    ):
        _write_attributes(file, attributes, data)
        _write_data(file, data)
        for name in data.keys() & (frames or {}).keys():
            file[name].attrs["frame"] = (frames or {})[name]


def inspect(path: Path, numbers: bool = True) -> Checkpoint:
    """Return what a path holds; every checksum is verified, those of numbers if asked for."""
    if not path.exists():
        return Checkpoint(Condition.MISSING)
    if not path.is_file():
        return Checkpoint(Condition.FOREIGN)
    with path.open("rb") as file:
        start = file.read(len(_HDF5_SIGNATURE))
    if start != _HDF5_SIGNATURE[: len(start)]:
        return Checkpoint(Condition.FOREIGN)
    try:
        with h5py.File(path, "r") as file:
            attributes = dict(file.attrs)
            if not isinstance(found := attributes.get("format"), str) or found != FORMAT:
                return Checkpoint(Condition.FOREIGN)
            if attributes.get("schema_version") != SCHEMA_VERSION:
                return Checkpoint(Condition.OTHER_VERSION, attributes)
            texts = {name: dataset[()] for name, dataset in file.items() if _is_text(dataset)}
            if attributes.pop("text_checksum") != _checksum(attributes, texts):
                return Checkpoint(Condition.DAMAGED)
            for dataset in file.values() if numbers else ():
                dataset[()]
    except Exception:
        return Checkpoint(Condition.DAMAGED)
    return Checkpoint(Condition.WHOLE, attributes)


def read(
    path: Path, runs: int | None = None, names: Container[str] = VOCABULARY, first: int = 0
) -> Data:
    """Return the named datasets of a whole checkpoint, of its runs ``first`` up to ``runs``."""
    data: Data = {}
    with h5py.File(path, "r") as file:
        for name, dataset in file.items():
            if name not in VOCABULARY or name not in names:
                continue
            value = dataset[first:runs] if has_runs(name) else dataset[()]
            data[name] = np.array([t.decode() for t in value]) if _is_text(dataset) else value
    return data


def frames(path: Path) -> dict[str, str]:
    """Return the axes and origin of those datasets of a whole checkpoint that say it."""
    with h5py.File(path, "r") as file:
        said = ((name, dataset.attrs.get("frame")) for name, dataset in file.items())
        return {name: str(frame) for name, frame in said if frame is not None}


def _is_text(dataset: Any) -> bool:
    return h5py.check_string_dtype(dataset.dtype) is not None


def _checksum(attributes: dict[str, Any], texts: Mapping[str, Any]) -> str:
    """Return a checksum of what HDF5 itself gives none: texts and text attributes."""
    content = {name: str(value) for name, value in attributes.items()}
    content |= {
        f"dataset {name}": repr([t if isinstance(t, str) else t.decode() for t in value])
        for name, value in texts.items()
    }
    return sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _write_attributes(file: Any, attributes: dict[str, Any], data: Data) -> None:
    texts = {name: value.tolist() for name, value in data.items() if value.dtype.kind in "US"}
    written = attributes | {
        "format": FORMAT,
        "schema_version": SCHEMA_VERSION,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "software": _software(),
        "commit": _commit(),
    }
    file.attrs.update(written | {"text_checksum": _checksum(written, texts)})


def _write_data(file: Any, data: Data) -> None:
    scales: dict[str, Any] = {}
    for name in sorted(data, key=lambda name: name not in COORDINATES):
        quantity, value = VOCABULARY[name], data[name]
        dataset = _create(file, name, value)
        dataset.attrs.update({"units": quantity.unit, "long_name": quantity.long_name})
        if name in COORDINATES:
            dataset.make_scale(name)
            scales[name] = dataset
            continue
        for axis, (label, length) in enumerate(zip(axes_of(name, value.ndim), value.shape)):
            if AXIS_LENGTH.get(label, length) != length:
                raise ValueError(f"{name} has {length} values along {label}")
            if label not in scales:
                scales[label] = file.create_dataset(label, data=np.zeros(length))
                scales[label].make_scale(f"{_NO_COORDINATE}{length:10d}")
            dataset.dims[axis].attach_scale(scales[label])


def _create(file: Any, name: str, value: Any) -> Any:
    if value.dtype.kind in "US":
        return file.create_dataset(name, data=value.tolist(), dtype=h5py.string_dtype())
    checked = value.size > 0 and value.ndim > 0
    return file.create_dataset(name, data=value.astype(np.float64), fletcher32=checked)


@cache
def _software() -> str:
    return ", ".join(f"{name} {version(name)}" for name in ("debrisest", "numpy", "scipy", "h5py"))


@cache
def _commit() -> str:
    """Return the commit of a source checkout, or nothing where there is none."""
    git = Path(__file__).resolve().parents[2] / ".git"
    try:
        head = (git / "HEAD").read_text().strip()
        return (git / head[5:]).read_text().strip() if head.startswith("ref: ") else head
    except OSError:
        return ""
