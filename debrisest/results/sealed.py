"""The bytes of a checkpoint: an HDF5 file, a label behind it, and a seal that is read first.

HDF5 ends where its own head says, so other programs open a sealed file as it is. The label (JSON)
holds the attributes of the file and the SHA-256 of its HDF5 part; the seal holds the SHA-256 of the
label. HDF5 is handed nothing that was not verified: it may hang on a single damaged page.
"""

import json
import os
import struct
from contextlib import suppress
from hashlib import sha256
from itertools import chain
from sys import intern
from typing import Any, BinaryIO, NamedTuple

FORMAT = "debrisest checkpoint"
_SEAL = struct.Struct("<32sQ24s")
_MARK = b"debrisest checkpoint end"
_HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_PART, _MOST = 2**20, 2**28
"""Of a file without a label, how much is read at once and looked at, in bytes."""
_BEFORE_SEALS = b"text_checksum"
"""An attribute of the files of versions that had no seal."""


class Label(NamedTuple):
    """What stands behind the HDF5 part of a file."""

    attributes: dict[str, Any]
    length: int
    """Of the HDF5 part, in bytes."""
    sha256: str
    """Of the HDF5 part."""
    digest: str = ""
    """Of the label itself."""


def sealed(image: bytes, attributes: dict[str, Any]) -> bytes:
    """Return the bytes of a checkpoint from an HDF5 file in memory and its attributes."""
    told = {"attributes": attributes, "length": len(image), "sha256": sha256(image).hexdigest()}
    label = json.dumps(told).encode()
    return b"".join((image, label, _SEAL.pack(sha256(label).digest(), len(label), _MARK)))


def read_label(file: BinaryIO) -> Label | None:
    """Return the label of an open file, or nothing where there is none that is whole."""
    size = file.seek(0, os.SEEK_END)
    seal = _tail(file, size, _SEAL.size)
    if len(seal) < _SEAL.size or not seal.endswith(_MARK):
        return None
    digest, length, _ = _SEAL.unpack(seal)
    label = _tail(file, size - _SEAL.size, length)
    if sha256(label).digest() != digest:
        return None
    told = _label(label)
    fits = told and told.length + length + _SEAL.size == size
    return told._replace(digest=digest.hex()) if told and fits else None


def read_image(file: BinaryIO, label: Label) -> bytes | None:
    """Return the HDF5 part of an open file, or nothing where it is not what was sealed."""
    file.seek(0)
    image = file.read(label.length)
    return image if sha256(image).hexdigest() == label.sha256 else None


def is_foreign(file: BinaryIO) -> bool:
    """Return whether a file without a label was never a checkpoint, neither whole nor in parts."""
    size = file.seek(0, os.SEEK_END)
    if _tail(file, size, len(_MARK)) == _MARK:
        return False
    file.seek(0)
    start = file.read(len(_HDF5_SIGNATURE))
    if start == _HDF5_SIGNATURE:
        content = start + file.read(min(size, _MOST))
        return FORMAT.encode() not in content and _is_complete(content, size)
    if _HDF5_SIGNATURE.startswith(start):
        return False
    rest = (file.read(_PART) for _ in range(0, min(size, _MOST), _PART))
    return size > _MOST or any(part.strip(b"\0") for part in chain((start,), rest))


def is_older(file: BinaryIO) -> bool:
    """Return whether a file without a label is of a version that had none."""
    size = file.seek(0, os.SEEK_END)
    file.seek(0)
    return _BEFORE_SEALS in file.read(min(size, _MOST))


def _is_complete(content: bytes, size: int) -> bool:
    """Return whether an HDF5 file is at least as long as its head says."""
    end = content[28:36] if content[8:9] in (b"\x02", b"\x03") else content[40:48]
    return size >= max(48, int.from_bytes(end, "little"))


def _label(text: bytes) -> Label | None:
    """Return what a label tells, if it is one."""
    with suppress(ValueError, TypeError, RecursionError):
        told = Label(**json.loads(text))
        if isinstance(told.attributes, dict) and type(told.length) is int:
            shared = {name: _shared(value) for name, value in told.attributes.items()}
            return told._replace(attributes=shared)
    return None


def _shared(value: Any) -> Any:
    """Return a text that many files have, such as the scenario, as the only one of its letters."""
    return intern(value) if type(value) is str else value


def _tail(file: BinaryIO, end: int, length: int) -> bytes:
    """Return up to ``length`` bytes before ``end``."""
    start = max(end - length, 0)
    file.seek(start)
    return file.read(end - start)
