"""Compute chunks of a stage together: read upstream, call once for all runs, a file for each.

A step that another goes with is followed by it, which sees all trajectories before they are left.
"""

import json
import pickle
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import groupby
from time import process_time
from typing import Any

import numpy as np

from debrisest.arrays import Data
from debrisest.counted import within
from debrisest.errors import UserError
from debrisest.results import store
from debrisest.results.address import Address
from debrisest.results.image import as_stored
from debrisest.results.status import difference
from debrisest.results.trajectories import thinned
from debrisest.runner.stages.isolate import isolate
from debrisest.runner.stages.pipeline import STAGES
from debrisest.runner.step import Step
from debrisest.scenario.resolved import resolved
from debrisest.vocabulary import VOCABULARY, has_runs


def compute(steps: Sequence[Step]) -> None:
    """Compute chunks of the same stage, case and estimator, and write their files."""
    step = steps[0]
    if step.computed_before:
        return
    for planned in filter(None, (step, step.then)):
        _require_planned(planned)
    reads = [_read(one) for one in steps]
    batches = groupby(zip(steps, reads), key=lambda pair: _shapes(pair[1]))
    for chunks, inputs in (zip(*batch) for _, batch in batches):
        result, seconds = _run(step, _together(inputs))
        for chunk, read, data in zip(chunks, inputs, _apart(result, chunks)):
            _write(chunk, data, seconds)
            if chunk.then is not None:
                store.require(chunk.path, chunk.attributes | {"runs": chunk.runs})
                _write(chunk.then, *_run(chunk.then, read | _seen_later(data, chunk)))


def _require_planned(step: Step) -> None:
    """Raise UserError where a measured file, or a plug-in, is not the one that was planned with."""
    found = STAGES[step.address.stage].inputs(step.case, step.address.estimator)
    if json.dumps(found) != json.dumps(step.inputs):
        raise UserError(
            f"{difference(step.inputs, found)}: a file changed since this was planned, or a worker "
            "has another one, or another plug-in; nothing was computed; run again"
        )
    if not step.upstream:
        _ = step.case.measured


def _run(step: Step, read: Data) -> tuple[Data, float]:
    """Return what a step makes of what it reads, as its file gives it back, and CPU s per run."""
    before = process_time()
    stage, estimator = STAGES[step.address.stage], step.address.estimator
    with within(step.name):
        result = isolate(lambda data: _declared(stage.run(step.case, estimator, data)), read)
    times = read["time_s"] if step.upstream else step.case.clock.times
    data = as_stored({"time_s": times, **result})
    return data, (process_time() - before) / len(data["run"])


def _write(step: Step, data: Data, seconds: float) -> None:
    """Write the file of a step whose runs took so many CPU seconds each."""
    scenario = step.case.scenario
    whole = max(0, scenario.whole_runs - step.address.first_run)
    kept, whole = thinned(data, step.address.stage, whole)
    told = {
        "whole_runs": whole,
        "failed_runs": int(np.count_nonzero(data["failure"] != "")),
        "cpu_s": round(seconds * step.runs, 4),
    }
    store.write(step.path, kept, _attributes(step) | told, scenario.frames)
    _remove_others(step)


def _remove_others(step: Step) -> None:
    """Remove files that began with later ones of the runs of a file: another filter cut them."""
    for path in step.path.parent.iterdir():
        other = Address.of(path)
        same = other and other[2:4] == step.address[2:4]
        if other and same and step.address.first_run < other.first_run < step.end:
            path.unlink(missing_ok=True)


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
        before = step.address.first_run - upstream.address.first_run
        end = before + step.runs
        expected = upstream.attributes | {"runs": end}
        found = store.read(upstream.path, end, first=before, expected=expected)
        data |= _seen_later(found, upstream)
    return data


def _seen_later(data: Data, step: Step) -> Data:
    """Return what a stage gave as later stages see it: its status under a name of its own."""
    own = f"{step.address.stage}_status"
    return {own if name == "status" else name: value for name, value in data.items()}


def _shapes(data: Data) -> dict[str, tuple[int, ...]]:
    """Return the shape of a run's share of each dataset: only chunks that agree are joined."""
    return {name: value.shape[has_runs(name) :] for name, value in data.items()}


def _together(inputs: Sequence[Data]) -> Data:
    """Return the chunks' datasets as one; what has no runs is the same in all of them."""
    first = inputs[0]
    if len(inputs) == 1:
        return first
    joined = {name: np.concatenate([d[name] for d in inputs]) for name in first if has_runs(name)}
    return first | joined


def _apart(data: Data, chunks: Sequence[Step]) -> Iterator[Data]:
    """Yield each chunk's share of the runs."""
    start = 0
    for chunk in chunks:
        share = slice(start, start + chunk.runs)
        yield {name: value[share] if has_runs(name) else value for name, value in data.items()}
        start += chunk.runs


def _attributes(step: Step) -> dict[str, Any]:
    simulation = step.upstream[0] if step.upstream else step
    return step.attributes | {
        "simulation": simulation.address.case,
        "runs": step.runs,
        "inputs": json.dumps(step.inputs),
        "scenario": _resolved(pickle.dumps(step.case)),
        "plugins": json.dumps({plugin.path: plugin.digest for plugin in step.case.plugins}),
        "seed": step.case.scenario.seed,
    }


@lru_cache
def _resolved(case: bytes) -> str:
    """Return the scenario that all files of a case have, of a case as it travels to workers."""
    return resolved(pickle.loads(case))
