"""The data of figures: of one run, of a simulation, or of all runs."""

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.results.assessed import Assessed, Result
from debrisest.results.results import Results
from debrisest.scenario.load import LoadedScenario


class Beside(NamedTuple):
    """What the tables have beside the errors of a figure, by quantity."""

    units: dict[str, str] = {}
    bound: Data = {}
    """Errors (run, time) of the efficient estimator, SI."""
    published: dict[str, float] = {}
    """Published medians of the runs' mean errors over the settled time, in the tables' unit."""


Wants: TypeAlias = Callable[[tuple[str, ...], set[str]], object]
"""Whether a figure is drawn that has these names, where there are these datasets."""
ALONE = Beside()
_NONE = np.zeros(0)


class Source(NamedTuple):
    """What a figure is drawn from, in names, in words and in data."""

    names: tuple[str, ...]
    """What tells the figure's file from others of its kind: case and estimator, or one of them."""
    context: str
    data: Data
    beside: Beside = ALONE


def always(names: tuple[str, ...], datasets: set[str]) -> bool:
    """Return that whatever can be drawn is."""
    return True


def single_runs(
    scenario: LoadedScenario,
    results: Results,
    errors: Assessed,
    run_asked: int | None = None,
    wants: Wants = always,
) -> Iterator[Source]:
    """Return a run of every case and estimator that has it: by default the first that did well."""
    for case in results.cases:
        for estimator in results.estimators(case):
            run = chosen_run(results, case, estimator, run_asked)
            names = (case, estimator, *_told(run_asked))
            if run is not None and wants(names, results.datasets_of_run(case, estimator, run)):
                context = f"{scenario.name}, case {case}, estimator {estimator}, run {run}"
                result = errors.get((case, estimator))
                if result is not None and result.diverged(scenario.common.tables.diverged)[run]:
                    context += " (its filter diverged)"
                data = results.one_run(case, estimator, run)
                yield Source(names, context, data)


def simulations(
    scenario: LoadedScenario,
    results: Results,
    run_asked: int | None = None,
    wants: Wants = always,
) -> Iterator[Source]:
    """Return what was simulated of a run, of every case that has it."""
    for case in results.cases:
        run, names = chosen_run(results, case, "", run_asked), (case, *_told(run_asked))
        if run is not None and wants(names, results.datasets_of_run(case, "", run)):
            context = f"{scenario.name}, case {case}, run {run}"
            yield Source(names, context, results.one_run(case, "", run))


def chosen_run(results: Results, case: str, estimator: str, asked: int | None = None) -> int | None:
    """Return the run that is asked for, if there is a result of it; by default the first one.

    By default one whose trajectories are kept, if there is one.
    """
    good = sorted(results.good_runs(case, estimator))
    if asked is not None:
        return asked if asked in good else None
    whole = (run for run in good if results.is_whole(case, estimator, run))
    return next(whole, min(good, default=None))


def _told(run_asked: int | None) -> tuple[str, ...]:
    return () if run_asked is None else (f"run_{run_asked}",)


def all_runs(
    scenario: LoadedScenario,
    results: Assessed,
    quantities: Sequence[str],
    wants: Wants = always,
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
        if not wants((estimator,), set(quantities)):
            continue
        chosen = [result for case, result in mine.items() if case in averaged]
        source = _pooled(scenario, estimator, chosen or list(mine.values()), quantities)
        if source is not None:
            yield source


def of_estimators(
    scenario: LoadedScenario,
    results: Assessed,
    quantities: Sequence[str],
    wants: Wants = always,
) -> Iterator[Source]:
    """Return the errors of all estimators of a case that has several, by ``quantity/estimator``.

    Runs that diverged, and estimators that lost all of them, are left out.
    """
    for case in dict.fromkeys(case for case, _ in results):
        data: Data = {}
        if not wants((case,), set(quantities)):
            continue
        for (of, estimator), result in results.items():
            good = result.good & ~result.diverged(scenario.common.tables.diverged)
            for name in quantities if of == case and good.any() else ():
                error = result.errors.get(name, _NONE)
                if error.shape[1:] == result.times.shape:
                    data |= {f"{name}/{estimator}": error[good], "time_s": result.times}
        if len({name.partition("/")[2] for name in data} - {""}) > 1:
            yield Source((case,), f"{scenario.name}, case {case}", data)


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
