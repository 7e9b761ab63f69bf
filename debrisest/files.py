"""Files that are there and whole, or not at all."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path to write to, which takes the place of ``path`` in one step.

    Where writing fails, ``path`` stays as it was. The file and its folder are synchronised.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{socket.gethostname()}.{os.getpid()}.tmp")
    try:
        yield temporary
        _synchronise(temporary)
        os.replace(temporary, path)
        _synchronise(path.parent)
    finally:
        temporary.unlink(missing_ok=True)


def remove_leftovers(folder: Path) -> None:
    """Remove temporary files of processes of this machine that no longer run."""
    for path in folder.rglob(".*.tmp"):
        host, _, process = path.name.removesuffix(".tmp").rpartition(".")
        if host.endswith(f".{socket.gethostname()}") and not _runs(process):
            path.unlink(missing_ok=True)


def _runs(process: str) -> bool:
    """Return whether a process is there and not a zombie; where that is unknown, it may be."""
    if not Path("/proc/self/stat").exists():
        return True
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except (OSError, IndexError):
        return False
    return state not in "ZX"


def _synchronise(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
