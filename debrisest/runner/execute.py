"""Run the steps of a plan on any ``concurrent.futures.Executor``, resuming from files."""

import errno
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from concurrent.futures.process import BrokenProcessPool
from typing import NamedTuple

from debrisest.errors import NO_MEMORY, UserError, refused
from debrisest.runner.compute import compute
from debrisest.runner.schedule import Schedule
from debrisest.runner.step import Step

_ENDING = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EAGAIN)
"""Where no other step could write its file either, or be computed."""


class Outcome(NamedTuple):
    """A finished step; ``error`` says why it wrote no file at all, where it did not."""

    step: Step
    error: str = ""


def trusted(step: Step) -> str:
    """Return that nothing lacks of a step that a worker reports to be done."""
    return ""


def execute(
    steps: Sequence[Step],
    pool: Executor,
    width: int,
    lacking: Callable[[Step], str] = trusted,
    starting: Callable[[Sequence[Step]], None] = lambda _: None,
) -> Iterator[Outcome]:
    """Run the steps that have a reason to, each after its upstream, at most ``width`` at a time.

    Chunks of the same stage that are ready are computed together, as many as suit its parts. A step
    that cannot write its file, by itself either, takes the steps that need it along; a worker that
    dies ends the whole execution, with an outcome for what was running. ``lacking`` says why a step
    that a worker reports to be done is not; ``starting`` is told which steps begin.
    """
    schedule = Schedule((step for step in steps if step.reason), width)
    running: dict[Future[None], list[Step]] = {}
    while True:
        while len(running) < width and (batch := schedule.take()):
            starting(batch)
            running[_submit(pool, batch)] = batch
        if not running:
            return
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            batch, error = running.pop(future), future.exception()
            if _ends_all(error):
                schedule.stop()
            elif error and len(batch) > 1:
                running |= {_submit(pool, [step]): [step] for step in batch}
                continue
            for step in batch:
                why = _sentence(error) if error else lacking(step)
                if not why:
                    schedule.done(step)
                yield Outcome(step, why)


def _ends_all(error: BaseException | None) -> bool:
    return isinstance(error, BrokenExecutor) or getattr(error, "errno", None) in _ENDING


def _submit(pool: Executor, batch: list[Step]) -> Future[None]:
    """Submit steps; a pool that is broken already gives a future that says so."""
    try:
        return pool.submit(compute, batch)
    except BrokenExecutor as error:
        broken: Future[None] = Future()
        broken.set_exception(error)
        return broken


def _sentence(error: BaseException) -> str:
    """Return why nothing was written; a pool of processes only tells that one ended."""
    if isinstance(error, BrokenProcessPool):
        return "a worker process was ended; run again to go on, with fewer --jobs if it recurs"
    if isinstance(error, OSError):
        return f"{refused(error)}; the same command goes on from here"
    if isinstance(error, MemoryError):
        return ": ".join([*getattr(error, "__notes__", []), NO_MEMORY])
    if isinstance(error, ImportError):
        return f"a library could not be loaded: {error}; the same command goes on from here"
    if isinstance(error, UserError | BrokenExecutor):
        return str(error)
    return f"{type(error).__name__}: {error}"
