"""The figures of all runs that tables are made of, read from one file after the other."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from debrisest.arrays import Array, Data
from debrisest.results.assessed import OF_FILES, Result, failed
from debrisest.results.results import Results
from debrisest.results.runs import SIMULATED, Runs
from debrisest.vocabulary import VOCABULARY


class Figure(NamedTuple):
    """What is asked of each run."""

    dataset: str
    statistic: str
    window: str


@dataclass(frozen=True)
class Figured(Runs):
    """All runs of one case and estimator, by the figures that were asked for: a number a run."""

    datasets: set[str]
    values: dict[Figure, Array]
    degrees: dict[Figure, Array]
    visible: dict[tuple[str, str], bool]
    """By dataset and window: whether any run has degrees of freedom, where files have them."""
    failures: Mapping[int, str]
    runs: int

    def has(self, dataset: str) -> bool:
        """Return whether any run has a dataset."""
        return dataset in self.datasets

    def figures(self, dataset: str, statistic: str, window: str) -> Array:
        """Return one figure per run (run,), in the unit of the tables; NaN where it failed."""
        return self.values[Figure(dataset, statistic, window)]

    def freedom(self, dataset: str, statistic: str, window: str) -> Array:
        """Return the degrees of freedom of each figure (run,), 0 where it is no chi-square."""
        return self.degrees[Figure(dataset, statistic, window)]

    def seen(self, dataset: str, window: str) -> bool:
        """Return whether any run can have a figure: with degrees of freedom, if it needs some."""
        return self.visible.get((dataset, window), True)


AllRuns: TypeAlias = Mapping[tuple[str, str], Runs]
"""All runs by case and estimator."""


def figured(
    results: Results,
    asked: Callable[[str], Collection[Figure]],
    simulated: Collection[str] = (),
) -> dict[tuple[str, str], Figured]:
    """Return the figures that are ``asked`` for of a case, by case and estimator.

    Those of the datasets ``simulated`` of the simulations come under the estimator SIMULATED.
    """
    found: dict[tuple[str, str], Figured] = {}
    for case in results.cases:
        figures = asked(case)
        if simulated and results.stages(case):
            shown = [one for one in figures if one.dataset in simulated]
            found[case, SIMULATED] = _figured(results.parts(case, names=_read(shown)), shown)
        for estimator in results.estimators(case):
            if "assess" in results.stages(case, estimator):
                parts = results.parts(case, estimator, "assess", _read(figures))
                found[case, estimator] = _figured(parts, figures)
    return found


def _read(figures: Collection[Figure]) -> set[str]:
    """Return the datasets that figures are made of."""
    laws = (VOCABULARY[one.dataset].chi_square for one in figures)
    freedom = {law.freedom for law in laws if law is not None}
    return {*OF_FILES, *freedom, *(one.dataset for one in figures)}


def _figured(parts: Iterable[Data], asked: Collection[Figure]) -> Figured:
    """Return the figures of the runs of all files, of which one is held at a time."""
    each: list[Figured] = []
    for data in parts:
        each.append(_of_file(data, asked, sum(one.runs for one in each)))
    visible: dict[tuple[str, str], bool] = {}
    for of, seen in (item for one in each for item in one.visible.items()):
        visible[of] = seen or visible.get(of, False)
    return Figured(
        set().union(*(one.datasets for one in each)),
        {figure: np.concatenate([one.values[figure] for one in each]) for figure in asked},
        {figure: np.concatenate([one.degrees[figure] for one in each]) for figure in asked},
        visible,
        {run: why for one in each for run, why in one.failures.items()},
        sum(one.runs for one in each),
    )


def _of_file(data: Data, asked: Collection[Figure], first: int) -> Figured:
    errors = {name: values for name, values in data.items() if name not in OF_FILES}
    failures = failed(data["failure"], first)
    result = Result(errors, data["time_s"], failures, len(data["run"]))
    shown = {(one.dataset, one.window) for one in asked}
    return Figured(
        set(errors),
        {figure: result.figures(*figure) for figure in asked},
        {figure: result.freedom(*figure) for figure in asked},
        {of: result.seen(*of) for of in shown if result.degrees(*of) is not None},
        failures,
        result.runs,
    )
