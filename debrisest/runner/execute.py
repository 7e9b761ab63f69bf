"""Run the steps of a plan on any ``concurrent.futures.Executor``, resuming from files."""

import errno
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.results import store
from debrisest.runner.plan import Step
from debrisest.runner.schedule import Schedule
from debrisest.runner.stages.isolate import isolate
from debrisest.runner.stages.pipeline import STAGES
from debrisest.scenario.resolved import resolved
from debrisest.vocabulary import VOCABULARY

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
"""Where no other step could write its file either."""


class Outcome(NamedTuple):
    """A finished step; ``error`` says why it wrote no file at all, where it did not."""

    step: Step
    error: str = ""


def execute(
    steps: Sequence[Step],
    pool: Executor,
    width: int,
    lacking: Callable[[Step], str] = lambda _: "",
) -> Iterator[Outcome]:
    """Run the steps that have a reason to, each after its upstream, at most ``width`` at a time.

    A step that cannot write its file takes the steps that need it along; a worker that dies ends
    the whole execution, with an outcome for what was running. ``lacking`` says why a step that a
    worker reports to be done is not.
    """
    schedule = Schedule(step for step in steps if step.reason)
    running: dict[Future[None], Step] = {}
    while True:
        for step in schedule.take(width - len(running)):
            running[_submit(pool, step)] = step
        if not running:
            return
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            step, error = running.pop(future), future.exception()
            if isinstance(error, BrokenExecutor):
                schedule.stop()
                yield Outcome(step, _said(error))
            elif error is not None:
                if getattr(error, "errno", None) in _NO_ROOM:
                    schedule.stop()
                yield Outcome(step, _sentence(error))
            elif why := lacking(step):
                yield Outcome(step, why)
            else:
                schedule.done(step)
                yield Outcome(step)


def _said(error: BrokenExecutor) -> str:
    """Return why nothing more can be computed; a pool of processes only tells that one ended."""
    if isinstance(error, BrokenProcessPool):
        return "a worker process was ended; run again to go on"
    return str(error)


def _submit(pool: Executor, step: Step) -> Future[None]:
    """Submit a step; a pool that is broken already gives a future that says so."""
    try:
        return pool.submit(run_step, step)
    except BrokenExecutor as error:
        broken: Future[None] = Future()
        broken.set_exception(error)
        return broken


def _sentence(error: BaseException) -> str:
    if isinstance(error, OSError) and error.filename:
        return f"{error.filename}: {error.strerror}; the same command goes on from here"
    return str(error) if isinstance(error, UserError) else f"{type(error).__name__}: {error}"


def run_step(step: Step) -> None:
    """Compute one step and write its file."""
    stage, estimator = STAGES[step.address.stage], step.address.estimator
    read = _read(step)
    result = isolate(lambda data: _declared(stage.run(step.case, estimator, data)), read)
    times = read["time_s"] if step.upstream else step.case.clock.times
    frames = step.case.scenario.frames
    store.write(step.path, {"time_s": times, **result}, _attributes(step), frames)


def _declared(data: Data) -> Data:
    """Return the same, or raise ValueError for what the vocabulary lacks."""
    if unknown := ", ".join(sorted(data.keys() - VOCABULARY.keys())):
        raise ValueError(f"no quantity is called {unknown}; a plug-in declares its own QUANTITIES")
    return data


def _read(step: Step) -> Data:
    """Return what the stages before this one stored, each one's status under its own name."""
    if not step.upstream:
        return {"run": step.address.first_run + np.arange(step.runs, dtype=float)}
    data: Data = {}
    for upstream in step.upstream:
        expected = upstream.attributes | {"runs": step.runs}
        found = store.read(upstream.path, step.runs, expected=expected)
        if "status" in found:
            found[f"{upstream.address.stage}_status"] = found.pop("status")
        data |= found
    return data


def _attributes(step: Step) -> dict[str, Any]:
    return step.attributes | {
        "runs": step.runs,
        "inputs": json.dumps(step.inputs),
        "scenario": resolved(step.case),
        "plugins": json.dumps({plugin.path: plugin.digest for plugin in step.case.plugins}),
        "seed": step.case.scenario.seed,
    }
