"""Compute chunks of a stage together: read upstream, call once for all runs, a file for each."""

import json
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

import numpy as np

from debrisest.arrays import Data
from debrisest.results import store
from debrisest.runner.plan import Step
from debrisest.runner.stages.isolate import isolate
from debrisest.runner.stages.pipeline import STAGES
from debrisest.scenario.resolved import resolved
from debrisest.vocabulary import VOCABULARY, has_runs


def compute(steps: Sequence[Step]) -> None:
    """Compute chunks of the same stage, case and estimator, and write their files."""
    step = steps[0]
    stage, estimator = STAGES[step.address.stage], step.address.estimator
    reads = [_read(one) for one in steps]
    batches = groupby(zip(steps, reads), key=lambda pair: _shapes(pair[1]))
    for chunks, inputs in (zip(*batch) for _, batch in batches):
        read = _together(inputs)
        result = isolate(lambda data: _declared(stage.run(step.case, estimator, data)), read)
        times = read["time_s"] if step.upstream else step.case.clock.times
        for chunk, data in zip(chunks, _apart({"time_s": times, **result}, chunks)):
            store.write(chunk.path, data, _attributes(chunk), step.case.scenario.frames)


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
        "scenario": resolved(step.case),
        "plugins": json.dumps({plugin.path: plugin.digest for plugin in step.case.plugins}),
        "seed": step.case.scenario.seed,
    }
