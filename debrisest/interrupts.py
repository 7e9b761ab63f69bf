"""Ctrl-C, SIGTERM, SIGHUP: the command line ends with a sentence, whatever it does just then.

Needs nothing but the standard library's start, so that it can listen before anything is imported.
"""

import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

SENTENCE = "interrupted: finished steps are kept, the same command goes on from there"
_HANGUPS = tuple(filter(None, (getattr(signal, "SIGHUP", None),)))  # Windows has none
SIGNALS = (
    signal.SIGINT,
    signal.SIGTERM,
    *(one for one in _HANGUPS if signal.getsignal(one) is signal.SIG_DFL),
)
"""What ends a command: a terminal that closes too, unless nohup has it go on."""
_last_acts: list[Callable[[], None]] = []


class Interrupted(KeyboardInterrupt):
    """A signal asked the command to end.

    ``exit_code`` is 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP.
    """

    def __init__(self, number: int = signal.SIGINT) -> None:
        self.exit_code = 128 + number


def listen() -> None:
    """End this process at once, with the sentence, from now on whenever a signal asks for it."""
    for number in SIGNALS:
        signal.signal(number, _end)
    sys.unraisablehook = _tell_unless_interrupted


def before_end(act: Callable[[], None]) -> None:
    """Let a signal that ends this process at once do this before."""
    _last_acts.append(act)


def ignore() -> None:
    """Let no signal take the exit code from a command that is over."""
    for number in SIGNALS:
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
        for number in SIGNALS:
            signal.signal(number, raise_interrupted)
        yield check
    finally:
        listen()
    check()


def _tell_unless_interrupted(swallowed: "sys.UnraisableHookArgs") -> None:
    if not isinstance(swallowed.exc_value, Interrupted):
        sys.__unraisablehook__(swallowed)


def _end(number: int, _: object) -> None:
    for act in _last_acts:
        with suppress(Exception):
            act()
    with suppress(Exception):
        sys.stdout.flush()
    os.write(2, f"{SENTENCE}\n".encode())
    os._exit(128 + number)
