"""Ctrl-C and SIGTERM: the command line ends with a sentence, whatever it is doing just then.

Needs nothing but the standard library's start, so that it can listen before anything is imported.
"""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

SENTENCE = "interrupted: finished steps are kept, the same command goes on from there"
_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interrupted(KeyboardInterrupt):
    """A signal asked the command to end; ``exit_code`` is 130 for Ctrl-C, 143 for SIGTERM."""

    def __init__(self, number: int = signal.SIGINT) -> None:
        self.exit_code = 128 + number


def listen() -> None:
    """End this process at once, with the sentence, from now on whenever a signal asks for it."""
    for number in _SIGNALS:
        signal.signal(number, _end)
    sys.unraisablehook = _tell_unless_interrupted


def ignore() -> None:
    """Let no signal take the exit code from a command that is over."""
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)


@contextmanager
def raised() -> Iterator[Callable[[], None]]:
    """Raise Interrupted within, so that what is open is closed; a second signal ends at once.

    Yields a check for between two steps: an exception that some callback swallowed is raised
    again. Where nobody listens, as in a notebook, signals stay what they are there.
    """
    seen: list[int] = []

    def raise_interrupted(number: int, _: object) -> None:
        seen.append(number)
        listen()
        raise Interrupted(number)

    def check() -> None:
        if seen:
            raise Interrupted(seen[0])

    if signal.getsignal(signal.SIGTERM) is not _end:
        yield check
        return
    try:
        for number in _SIGNALS:
            signal.signal(number, raise_interrupted)
        yield check
    finally:
        listen()
    check()


def _tell_unless_interrupted(swallowed: "sys.UnraisableHookArgs") -> None:
    if not isinstance(swallowed.exc_value, Interrupted):
        sys.__unraisablehook__(swallowed)


def _end(number: int, _: object) -> None:
    with suppress(Exception):
        sys.stdout.flush()
    os.write(2, f"{SENTENCE}\n".encode())
    os._exit(128 + number)
