"""Run the steps of a plan on any ``concurrent.futures.Executor``, resuming from files."""

import errno
import json
import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.results import store
from debrisest.runner.plan import Step
from debrisest.runner.stages.isolate import isolate
from debrisest.runner.stages.pipeline import STAGES
from debrisest.vocabulary import VOCABULARY

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)
"""Where no other step could write its file either."""


class Outcome(NamedTuple):
    """A finished step; ``error`` says why it wrote no file at all, where it did not."""

    step: Step
    error: str = ""


class InProcess(Executor):
    """An executor that computes at once, in this process."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Compute now and return a finished future."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


class WorkerPool(ProcessPoolExecutor):
    """Spawned processes that leave Ctrl-C to this one: they start with it blocked."""

    def __init__(self, jobs: int) -> None:
        super().__init__(jobs, mp_context=multiprocessing.get_context("spawn"))

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submit as the pool does, starting workers with Ctrl-C blocked."""
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            return super().submit(fn, *args, **kwargs)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def __exit__(self, *error: Any) -> None:
        """Wait for the workers, or end them where an error leaves the pool."""
        if error[0] is None:
            self.shutdown()
            return
        self.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()


@contextmanager
def executor(jobs: int, address: str | None = None) -> Iterator[tuple[Executor, int]]:
    """Yield an executor and how many steps it computes at a time.

    It is this process, a pool of ``jobs`` spawned ones, or a dask cluster.
    """
    if address is not None:
        from debrisest.runner.cluster import dask_executor

        with dask_executor(address) as cluster:
            yield cluster
    else:
        with InProcess() if jobs == 1 else WorkerPool(jobs) as pool:
            yield pool, jobs


def execute(steps: Sequence[Step], pool: Executor, width: int) -> Iterator[Outcome]:
    """Run the steps that have a reason to, each after its upstream, at most ``width`` at a time.

    A step that cannot write its file takes the steps that need it along; a worker that dies ends
    the whole execution, with an outcome for what was running.
    """
    waiting = [step for step in steps if step.reason]
    unfinished = {step.path for step in waiting}
    running: dict[Future[None], Step] = {}
    while waiting or running:
        ready = [s for s in waiting if not unfinished & {up.path for up in s.upstream}]
        for step in ready[: max(width - len(running), 0)]:
            waiting.remove(step)
            running[_submit(pool, step)] = step
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            step, error = running.pop(future), future.exception()
            if isinstance(error, BrokenExecutor):
                waiting = []
                yield Outcome(step, "a worker process was ended; run again to go on")
            elif error is not None:
                waiting = [w for w in waiting if step.path not in {up.path for up in w.upstream}]
                if getattr(error, "errno", None) in _NO_ROOM:
                    waiting = []
                yield Outcome(step, _sentence(error))
            else:
                unfinished.discard(step.path)
                yield Outcome(step)


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
        "scenario": step.case.as_yaml(),
        "plugins": json.dumps({plugin.path: plugin.digest for plugin in step.case.plugins}),
        "seed": step.case.scenario.seed,
    }
