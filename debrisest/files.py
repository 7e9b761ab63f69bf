"""Files that are there and whole, or not at all."""

import errno
import os
import secrets
import socket
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from math import inf
from pathlib import Path

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]


MOST_BYTES = 20_000_000
"""Of a text that a person writes: a scenario, published values, a start."""
_ours: set[Path] = set()
"""The temporary files that this process writes to."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path to write to, which takes the place of ``path`` in one step.

    Where writing fails, ``path`` stays as it was, and OSError names it. The file and its folder are
    synchronised. The temporary file is locked for as long as its writer is alive.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with _temporary(path.parent) as temporary:
            yield temporary
            _synchronise(temporary)
            os.replace(temporary, path)
            _synchronise(path.parent)
    except OSError as error:
        if error.errno is None or not str(error.filename or ".tmp").endswith(".tmp"):
            raise
        raise OSError(error.errno, os.strerror(error.errno), str(path)) from None


def content(path: Path) -> bytes:
    """Return what a file holds; OSError also for a pipe or a device, which may never end."""
    require_ending(path)
    return path.read_bytes()


def require_ending(path: Path, most: float = inf) -> None:
    """Raise OSError for a pipe or a device, which may never end, and above ``most`` bytes."""
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise OSError(errno.EINVAL, "this is a pipe or a device, not a file", str(path))
    if path.is_file() and path.stat().st_size > most:
        raise OSError(errno.EFBIG, f"over {most / 1e6:g} MB", str(path))


def alike(name: str) -> str:
    """Return a key that names share which some disk takes for one: but for capitals, accents.

    Letters with accents can be written as one sign or as two.
    """
    return unicodedata.normalize("NFD", unicodedata.normalize("NFD", name).casefold())


def put(path: Path, content: bytes) -> None:
    """Write a file in one step unless it holds just this already, on a disk to read from, say."""
    if not (path.is_file() and path.read_bytes() == content):
        with replacing(path) as temporary:
            temporary.write_bytes(content)


def remove_leftovers(folder: Path) -> None:
    """Remove temporary files of this machine whose writers are no longer alive."""
    for path in folder.rglob(".*.tmp"):
        if path.name.removesuffix(".tmp").split(".", 2)[2:] == [socket.gethostname()]:
            with suppress(OSError):
                _remove_unlocked(path)


def remove_own() -> None:
    """Remove the temporary files that this process writes to, for it ends just now."""
    for path in tuple(_ours):
        with suppress(OSError):
            path.unlink(missing_ok=True)


def lock(descriptor: int, wait: bool = False) -> None:
    """Lock an open file; raise BlockingIOError where another process has, OSError without locks."""
    if fcntl is None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
    fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB * (not wait))


@contextmanager
def _temporary(folder: Path) -> Iterator[Path]:
    """Yield a new file that is locked, and removed if it is still there in the end."""
    path, descriptor = _locked_file(folder)
    _ours.add(path)
    try:
        yield path
    finally:
        with suppress(OSError):
            path.unlink(missing_ok=True)
        _ours.discard(path)
        os.close(descriptor)


def _locked_file(folder: Path) -> tuple[Path, int]:
    while True:
        path = folder / f".{secrets.token_hex(6)}.{socket.gethostname()}.tmp"
        descriptor = os.open(path, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666)
        with suppress(OSError):  # of a file system without locks
            lock(descriptor, wait=True)
        if os.fstat(descriptor).st_nlink:  # else it was taken for a leftover before it was locked
            return path, descriptor
        os.close(descriptor)


def _remove_unlocked(path: Path) -> None:
    """Remove a file, or raise OSError where a process holds it or locks cannot tell."""
    descriptor = os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0))  # of a pipe: ENXIO
    try:
        lock(descriptor)
        path.unlink(missing_ok=True)
    finally:
        os.close(descriptor)


def _synchronise(path: Path) -> None:
    if os.name == "nt":  # folders cannot be opened there, nor files be synchronised by reading
        return
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
