"""Checkpoints: one file per stage and chunk of runs, whole or not there at all.

A file is made in memory, sealed, written under a temporary name, synchronised, and renamed. It is
verified as a whole before anything is read from it.
"""

from collections.abc import Container, Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from enum import Enum
from functools import cache, lru_cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from debrisest import compiled
from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.files import replacing
from debrisest.results.image import check, data_of, frames_of, opened
from debrisest.results.sealed import (
    FORMAT,
    Label,
    is_foreign,
    is_older,
    read_image,
    read_label,
    sealed,
)
from debrisest.results.told import forms, require_told
from debrisest.results.written import image_of
from debrisest.revision import commit
from debrisest.vocabulary import VOCABULARY

SCHEMA_VERSION = 6
_BROKEN = (ValueError, OSError, RuntimeError, KeyError, TypeError, AttributeError)
"""What reading an HDF5 file raises that is not as it should be."""


class Condition(Enum):
    """What a path holds, as words that follow «the file is»."""

    WHOLE = "whole"
    MISSING = "missing"
    DAMAGED = "truncated or damaged"
    OTHER_VERSION = "of another version of debrisest"
    FOREIGN = "not a checkpoint of debrisest"
    ANOTHER = "another one than was expected there"


class Checkpoint(NamedTuple):
    """What is known of a file without using its data."""

    condition: Condition
    attributes: dict[str, Any] = {}
    digest: str = ""
    """Of its label, which has that of its numbers."""


def write(
    path: Path, data: Data, attributes: dict[str, Any], frames: Mapping[str, str] | None = None
) -> None:
    """Write a checkpoint in one step: afterwards it is there and whole, or as it was before.

    ``frames`` becomes the attribute ``frame`` of the datasets it names. Raises OSError with the
    path where there is no room, or no right to write.
    """
    told = attributes | {
        "format": FORMAT,
        "schema_version": SCHEMA_VERSION,
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "software": _software(),
        "commit": commit(),
        "datasets": forms(data),
    }
    content = sealed(image_of(data, told, frames or {}), told)
    with replacing(path) as temporary:
        temporary.write_bytes(content)


class Depth(Enum):
    """How far a file is looked into; reading its data verifies all of it."""

    LABEL = "its label and its length"
    BYTES = "the digest of all its bytes too"
    DATASETS = "each of its datasets too"


def inspect(path: Path, depth: Depth = Depth.DATASETS) -> Checkpoint:
    """Return what a path holds, verified as far as is asked for."""
    found, image = _look(path, depth)
    try:
        if image and depth is Depth.DATASETS:
            check(image, found.attributes)
    except _BROKEN:
        return Checkpoint(Condition.DAMAGED, found.attributes)
    return found


def read(
    path: Path,
    runs: int | None = None,
    names: Container[str] = VOCABULARY,
    first: int = 0,
    expected: Mapping[str, Any] | None = None,
) -> Data:
    """Return the named datasets of a checkpoint, of its runs ``first`` up to ``runs``.

    Raises UserError where the file is not whole, has fewer runs or an attribute that is not as
    ``expected``: whatever happened since it was inspected, no data are taken for those of another.
    """
    with _whole(path, expected or {}) as (file, attributes):
        return data_of(file, attributes, names, first, runs)


def frames(path: Path) -> dict[str, str]:
    """Return the axes and origin of those datasets of a checkpoint that say it."""
    with _whole(path, {}) as (file, _):
        return frames_of(file)


def require(path: Path, expected: Mapping[str, Any]) -> None:
    """Raise UserError unless a file is there, as its label has it, with attributes as expected."""
    condition, attributes, _ = inspect(path, Depth.LABEL)
    if condition is Condition.WHOLE and not fits(attributes, expected):
        condition = Condition.ANOTHER
    if condition is not Condition.WHOLE:
        raise UserError(_told(path, condition))


@contextmanager
def _whole(path: Path, expected: Mapping[str, Any]) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Yield the verified HDF5 file of a checkpoint and its attributes, or raise UserError."""
    (condition, attributes, _), image = _look(path)
    if condition is Condition.WHOLE and not fits(attributes, expected):
        condition = Condition.ANOTHER
    if condition is not Condition.WHOLE:
        raise UserError(_told(path, condition))
    try:
        with opened(image) as file:
            yield file, attributes
    except _BROKEN:
        said = "its datasets are not those that a step writes; delete it, and a sweep computes it"
        raise UserError(f"{path} is {Condition.DAMAGED.value}: {said} again") from None


def fits(attributes: Mapping[str, Any], expected: Mapping[str, Any]) -> bool:
    """Return whether attributes are as expected, and there are as many runs or more."""
    same = all(attributes.get(k) == value for k, value in expected.items() if k != "runs")
    return same and attributes.get("runs", 0) >= expected.get("runs", 0)


def _look(path: Path, depth: Depth = Depth.DATASETS) -> tuple[Checkpoint, bytes]:
    """Return what a path holds, and its HDF5 part if it is whole and its datasets are asked for."""
    if not path.exists():
        return Checkpoint(Condition.MISSING), b""
    if not path.is_file():
        return Checkpoint(Condition.FOREIGN), b""
    if depth is Depth.DATASETS:
        return _read(path)
    state = _state(path)
    found, label = _labelled(path, state)
    wrong = depth is Depth.BYTES and label is not None and not _is_sealed(path, state)
    return found._replace(condition=Condition.DAMAGED) if wrong else found, b""


def _read(path: Path) -> tuple[Checkpoint, bytes]:
    with path.open("rb") as file:
        found, label = _label_in(file)
        image = read_image(file, label) if label else b""
    return found if image is not None else found._replace(condition=Condition.DAMAGED), image or b""


def _state(path: Path) -> tuple[int, ...]:
    """Return what changes where a file is written to or replaced."""
    found = path.stat()
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


@lru_cache(maxsize=10_000)
def _labelled(path: Path, _: tuple[int, ...]) -> tuple[Checkpoint, Label | None]:
    """Return what the label of a file tells, which a command asks for several times."""
    with path.open("rb") as file:
        return _label_in(file)


@lru_cache(maxsize=10_000)
def _is_sealed(path: Path, state: tuple[int, ...]) -> bool:
    """Return whether the HDF5 part of a file is what its label says."""
    _, label = _labelled(path, state)
    with path.open("rb") as file:
        return label is not None and read_image(file, label) is not None


def _label_in(file: BinaryIO) -> tuple[Checkpoint, Label | None]:
    """Return what is known of an open file without its numbers, and its label if that is whole."""
    label = read_label(file)
    if label is None:
        return Checkpoint(_without_label(file)), None
    if label.attributes.get("schema_version") != SCHEMA_VERSION:
        return Checkpoint(Condition.OTHER_VERSION, label.attributes), None
    try:
        require_told(label.attributes)
    except ValueError:
        return Checkpoint(Condition.DAMAGED), None
    return Checkpoint(Condition.WHOLE, label.attributes, label.digest), label


def _told(path: Path, condition: Condition) -> str:
    return f"{path} is {condition.value}; a sweep computes it again"


def _without_label(file: BinaryIO) -> Condition:
    if is_foreign(file):
        return Condition.FOREIGN
    return Condition.OTHER_VERSION if is_older(file) else Condition.DAMAGED


@cache
def _software() -> str:
    names = ["debrisest", "numpy", "scipy", "h5py", *["numba"] * bool(compiled.version())]
    return ", ".join(f"{name} {version(name)}" for name in names)
