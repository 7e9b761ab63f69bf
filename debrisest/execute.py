"""Run the steps of a plan on any ``concurrent.futures.Executor``, resuming from files."""

import json
import multiprocessing
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np

from debrisest import store
from debrisest.arrays import Data
from debrisest.plan import Step
from debrisest.stages.isolate import isolate
from debrisest.stages.pipeline import STAGES


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


@contextmanager
def executor(jobs: int, address: str | None = None) -> Iterator[Executor]:
    """Yield an executor: this process, a pool of ``jobs`` spawned ones, or a dask cluster."""
    if address is not None:
        from debrisest.cluster import dask_executor

        with dask_executor(address) as cluster:
            yield cluster
    elif jobs == 1:
        yield InProcess()
    else:
        pool = ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn"))
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in multiprocessing.active_children():
                process.terminate()
            raise
        pool.shutdown()


def execute(steps: Sequence[Step], pool: Executor, width: int) -> Iterator[Outcome]:
    """Run the steps that have a reason to, each after its upstream, at most ``width`` at a time."""
    waiting = [step for step in steps if step.reason]
    unfinished = {step.path for step in waiting}
    running: dict[Future[None], Step] = {}
    while waiting or running:
        ready = [s for s in waiting if not unfinished & {up.path for up in s.upstream}]
        for step in ready[: max(width - len(running), 0)]:
            waiting.remove(step)
            running[pool.submit(run_step, step)] = step
        finished, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in finished:
            step = running.pop(future)
            error = future.exception()
            if error is None:
                unfinished.discard(step.path)
                yield Outcome(step)
                continue
            waiting = [w for w in waiting if step.path not in {up.path for up in w.upstream}]
            yield Outcome(step, f"{type(error).__name__}: {error}")


def run_step(step: Step) -> None:
    """Compute one step and write its file."""
    if multiprocessing.parent_process() is not None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    stage = STAGES[step.stage]
    result = isolate(lambda data: stage.run(step.case, step.estimator, data), _read(step))
    store.write(step.path, _with_coordinates(result, step), _attributes(step))


def failures_of(data: Data) -> dict[int, str]:
    """Return the reasons of the runs that gave no result."""
    return {int(run): str(why) for run, why in zip(data["run"], data["failure"]) if why}


def _read(step: Step) -> Data:
    if not step.upstream:
        return {"run": np.arange(step.first_run, step.first_run + step.runs, dtype=float)}
    data: Data = {}
    for upstream in step.upstream:
        data |= store.read(upstream.path, step.runs)
    return data


def _with_coordinates(result: Data, step: Step) -> Data:
    """Give a file the coordinates of its axes, so that it can be read alone."""
    if not step.upstream:
        return result
    times = store.read(step.upstream[0].path)["time_s"]
    return {"time_s": times, **result}


def _attributes(step: Step) -> dict[str, Any]:
    return {
        "stage": step.stage,
        "estimator": step.estimator,
        "case": step.case.name,
        "first_run": step.first_run,
        "runs": step.runs,
        "stage_key": step.key,
        "inputs": json.dumps(step.inputs, sort_keys=True),
        "scenario": step.case.as_yaml(),
        "seed": step.case.scenario.seed,
    }
