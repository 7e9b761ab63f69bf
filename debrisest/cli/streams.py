"""Standard output and standard error, whatever they lead to."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any


class _Output:
    """A stream whose failures are told as those of standard output."""

    def __init__(self, stream: Any) -> None:
        self.stream = stream

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)

    def write(self, text: str) -> int:
        """Write as the stream does."""
        return int(self._tried(self.stream.write, text))

    def flush(self) -> None:
        """Flush as the stream does."""
        self._tried(self.stream.flush)

    def _tried(self, act: Any, *arguments: Any) -> Any:
        try:
            return act(*arguments)
        except OSError as error:
            _forget(self.stream)
            raise OSError(error.errno, error.strerror, "standard output") from None


class _Messages(_Output):
    """A stream whose failures stop nothing: there is nowhere to tell them."""

    def _tried(self, act: Any, *arguments: Any) -> Any:
        with suppress(OSError):
            return act(*arguments)
        return 0


@contextmanager
def steady() -> Iterator[None]:
    """Let printing never stop what is done besides: within it, and at the end of the process.

    A closed stream leads nowhere; what a code page lacks is written out; OSError of standard output
    names it, those of standard error are left out.
    """
    before: Any = sys.stdout, sys.stderr
    streams: Any = [stream or open(os.devnull, "w") for stream in before]  # noqa: SIM115
    for stream in streams:
        with suppress(AttributeError):
            stream.reconfigure(errors="backslashreplace")
    sys.stdout, sys.stderr = _Output(streams[0]), _Messages(streams[1])
    try:
        yield
    finally:
        sys.stdout, sys.stderr = before


def _forget(stream: Any) -> None:
    """Lead a broken stream nowhere, so that what it still holds does not fail again at the end."""
    with suppress(OSError, ValueError), open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), stream.fileno())
