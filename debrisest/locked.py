"""A folder that one command at a time writes to."""

import os
import socket
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from debrisest.errors import UserError
from debrisest.files import lock

LOCK = ".lock"
_NEXT = "wait until it ends, or choose another folder with --out"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder's lock, which ends with the process that holds it, however it ends.

    Raises UserError, with who holds it, where another process does, and where something else than
    a file has the lock's name. A folder that cannot be written to, or whose file system has no
    locks, is not locked.
    """
    path = folder / LOCK
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = _hold(path)
    except BlockingIOError:
        raise UserError(f"{folder}: {_holder(path)} writes there now; {_NEXT}") from None
    except OSError:
        _require_file(path)
        descriptor = None
    try:
        yield
    finally:
        if descriptor is not None:
            path.unlink(missing_ok=True)
            os.close(descriptor)


def _hold(path: Path) -> int:
    """Return the open file of a lock that is now held; raise BlockingIOError if another does."""
    while True:
        descriptor = os.open(path, os.O_CREAT | os.O_RDWR, 0o666)
        try:
            lock(descriptor)
            if path.exists() and os.path.samestat(os.fstat(descriptor), path.stat()):
                os.ftruncate(descriptor, 0)
                told = f"process {os.getpid()} on {socket.gethostname()}"
                with suppress(OSError):  # of a disk that is full: the lock holds without a name
                    os.write(descriptor, told.encode())
                return descriptor
        except OSError:
            os.close(descriptor)
            raise
        os.close(descriptor)  # of a file that was removed before it was locked


def _require_file(path: Path) -> None:
    """Raise UserError where what has the lock's name cannot be one."""
    with suppress(OSError):
        if not stat.S_ISREG(path.lstat().st_mode):
            raise UserError(f"{path}: this is no file, so that it cannot be a lock; move it away")


def _holder(path: Path) -> str:
    with suppress(OSError, ValueError):
        return path.read_text() or "another command"
    return "another command"
