"""How far a long step is: what computes counts its parts, whoever shows progress hears of them.

Where nobody listens, nothing is told. Threads that are started have listeners of their own.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from typing import NamedTuple, TypeVar

_Item = TypeVar("_Item")


class Part(NamedTuple):
    """How far a step is."""

    step: str
    """Its name; empty outside of a step."""
    what: str
    """What is counted, such as images."""
    done: int
    total: int

    def __str__(self) -> str:
        """Return the step, if there is one, and what is counted."""
        return f"{self.step}: {self.what}" if self.step else self.what


Listener = Callable[[Part], None]
_listener: ContextVar[Listener] = ContextVar("listener", default=lambda _: None)
_step: ContextVar[str] = ContextVar("step", default="")


def counted(items: Sequence[_Item], what: str) -> Iterator[_Item]:
    """Yield the items, and tell after each how many are done."""
    for done, item in enumerate(items, start=1):
        yield item
        tell(what, done, len(items))


def tell(what: str, done: int, total: int) -> None:
    """Tell that so many of what is counted are done."""
    _listener.get()(Part(_step.get(), what, done, total))


def listener() -> Listener:
    """Return who listens."""
    return _listener.get()


def listen(who: Listener) -> None:
    """Let someone listen from now on."""
    _listener.set(who)


@contextmanager
def heard_by(who: Listener) -> Iterator[None]:
    """Let someone listen to what is done within."""
    before = _listener.set(who)
    try:
        yield
    finally:
        _listener.reset(before)


@contextmanager
def within(step: str) -> Iterator[None]:
    """Name the step to which belongs what is told within."""
    before = _step.set(step)
    try:
        yield
    finally:
        _step.reset(before)
