"""The data of figures: what is up to date in the store, of one run or of all runs."""

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.results import store
from debrisest.run.plan import Step
from debrisest.scenario.load import LoadedScenario
from debrisest.show.tables.cells import Results
from debrisest.show.tables.results import Result
from debrisest.vocabulary import has_runs

Chunks = dict[int, list[Step]]
"""The steps of one case and estimator by their first run, upstream first."""


class Source(NamedTuple):
    """What a figure is drawn from, in names, in words and in data."""

    names: tuple[str, ...]
    """What tells the figure's file from others of its kind: case and estimator, or estimator."""
    context: str
    data: Data


def single_runs(
    scenario: LoadedScenario, steps: Iterable[Step], results: Results
) -> Iterator[Source]:
    """Return the first run that did not fail, of every case and estimator that has one."""
    for (case, estimator), chunks in _chunks(list(steps)).items():
        found = _first_good_run(chunks)
        if found is not None:
            run, data = found
            context = f"{scenario.name}, case {case}, estimator {estimator}, run {run}"
            result = results.get((case, estimator))
            if result is not None and result.diverged(scenario.common.tables.diverged)[run]:
                context += " (its filter diverged)"
            yield Source((case, estimator), context, data)


def simulations(scenario: LoadedScenario, steps: Iterable[Step]) -> Iterator[Source]:
    """Return what was simulated of the first run that did not fail, of every case."""
    chunks: dict[str, Chunks] = {}
    for step in steps:
        if step.stage == "simulate":
            chunks.setdefault(step.case.name, {})[step.first_run] = [step]
    for case, found in chunks.items():
        first = _first_good_run(found)
        if first is not None:
            yield Source((case,), f"{scenario.name}, case {case}, run {first[0]}", first[1])


def all_runs(
    scenario: LoadedScenario, results: Results, quantities: Sequence[str]
) -> Iterator[Source]:
    """Return, for every estimator, the errors of the runs of all cases that did not diverge.

    Where the scenario's tables have means, the cases are those of the means.
    """
    averaged = {case for cases in scenario.common.tables.means.values() for case in cases}
    for estimator in dict.fromkeys(estimator for _, estimator in results):
        mine = {
            case: result
            for (case, of), result in results.items()
            if of == estimator and set(quantities) <= set(result.errors)
        }
        chosen = [result for case, result in mine.items() if case in averaged]
        source = _pooled(scenario, estimator, chosen or list(mine.values()), quantities)
        if source is not None:
            yield source


def _chunks(steps: Sequence[Step]) -> dict[tuple[str, str], Chunks]:
    found: dict[tuple[str, str], Chunks] = {}
    for step in steps:
        if step.estimator:
            chunk = found.setdefault((step.case.name, step.estimator), {})
            chunk.setdefault(step.first_run, list(step.upstream[:1])).append(step)
    return found


def _first_good_run(chunks: Chunks) -> tuple[int, Data] | None:
    """Return the number and the datasets, without their run axis, of the first good run."""
    for first in sorted(chunks):
        parts = [store.read(s.path, s.runs) for s in chunks[first] if not s.reason]
        if not parts:
            continue
        failed = np.any([part["failure"] != "" for part in parts], axis=0)
        if not failed.all():
            index = int(np.argmin(failed))
            return first + index, _one_run(parts, index)
    return None


def _one_run(parts: Iterable[Data], index: int) -> Data:
    return {
        name: value[index] if has_runs(name) else value
        for part in parts
        for name, value in part.items()
    }


def _pooled(
    scenario: LoadedScenario, estimator: str, results: Sequence[Result], quantities: Sequence[str]
) -> Source | None:
    """Return the errors (run, time) of all good runs, on the epochs of all cases."""
    kept = [_kept(scenario, result, quantities) for result in results]
    runs = sum(result.runs for result in results)
    good = sum(int(mine.sum()) for mine in kept)
    failed = sum(len(result.failures) for result in results)
    if not good:
        return None
    times = np.unique(np.concatenate([result.times for result in results]))
    data: Data = {"time_s": times}
    for name in quantities:
        parts = [_on(times, r.times, r.errors[name][mine]) for r, mine in zip(results, kept)]
        data[name] = np.concatenate(parts)
    cases = "1 case" if len(results) == 1 else f"{len(results)} cases"
    context = (
        f"{scenario.name}, estimator {estimator}, {cases}, {runs} runs; "
        f"left out: {runs - good - failed} diverged" + (f", {failed} failed" if failed else "")
    )
    return Source((estimator,), context, data)


def _kept(scenario: LoadedScenario, result: Result, quantities: Sequence[str]) -> BoolArray:
    """Return which runs (run,) are finite to the end and break no rule of divergence."""
    finite = [np.isfinite(result.errors[name][:, -1]) for name in quantities]
    lost = result.diverged(scenario.common.tables.diverged)
    return np.asarray(result.good & ~lost & np.all(finite, axis=0))


def _on(times: Array, own: Array, error: Array) -> Array:
    """Return an error (run, own time) on more epochs, NaN where it has none."""
    spread = np.full((len(error), len(times)), np.nan)
    spread[:, np.searchsorted(times, own)] = error
    return spread
