"""The errors of all runs of one case and estimator, read when they are asked for."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from debrisest.arrays import Array
from debrisest.assessment.consistency import dof_of_runs
from debrisest.assessment.statistics import per_run, window_mask
from debrisest.results.results import Results
from debrisest.results.runs import Runs
from debrisest.scenario.window import window_of
from debrisest.vocabulary import VOCABULARY, table_scale

OF_FILES = {"run", "time_s", "failure"}
"""What every file holds beside its own datasets."""


@dataclass(frozen=True)
class Result(Runs):
    """All runs of one case and estimator, or of a file: errors by quantity in SI."""

    errors: Mapping[str, Array]
    times: Array
    failures: Mapping[int, str]
    runs: int

    def has(self, dataset: str) -> bool:
        """Return whether any run has a dataset."""
        return dataset in self.errors

    def figures(self, dataset: str, statistic: str, window: str) -> Array:
        """Return one figure per run (run,), in the unit of the tables; NaN where it failed."""
        if dataset not in self.errors:
            return np.full(self.runs, np.nan)
        inside = window_mask(self.times, window_of(window, float(self.times[-1])))
        return per_run(statistic, self.errors[dataset], inside) * table_scale(dataset)

    def freedom(self, dataset: str, statistic: str, window: str) -> Array:
        """Return the degrees of freedom of each figure (run,), 0 where it is no chi-square."""
        degrees = self.degrees(dataset, window)
        law = VOCABULARY[dataset].chi_square
        if degrees is None or law is None:
            return np.zeros(self.runs)
        return dof_of_runs(statistic, degrees, law.white)

    def seen(self, dataset: str, window: str) -> bool:
        """Return whether any run can have a figure: with degrees of freedom, if it needs some."""
        degrees = self.degrees(dataset, window)
        return degrees is None or bool((degrees > 0).any())

    def degrees(self, dataset: str, window: str) -> Array | None:
        """Return the degrees of freedom of each epoch (run, epoch) of a window, where there are."""
        law = VOCABULARY[dataset].chi_square
        if law is None or law.freedom not in self.errors:
            return None
        inside = window_mask(self.times, window_of(window, float(self.times[-1])))
        return np.nan_to_num(self.errors[law.freedom][:, inside])


Assessed: TypeAlias = Mapping[tuple[str, str], Result]
"""Results by case and estimator."""


def assessed(results: Results) -> dict[tuple[str, str], Result]:
    """Return what was assessed, by case and estimator."""
    return {
        (case, estimator): _result(results, case, estimator)
        for case in results.cases
        for estimator in results.estimators(case)
        if "assess" in results.stages(case, estimator)
    }


def _result(results: Results, case: str, estimator: str) -> Result:
    told = results.load(case, estimator, "assess", OF_FILES)
    names = results.datasets(case, estimator, "assess") - OF_FILES

    def load(name: str) -> Array:
        return np.asarray(results.load(case, estimator, "assess", {name})[name])

    return Result(_Read(names, load), told["time_s"], failed(told["failure"]), len(told["run"]))


def failed(failure: Array, first: int = 0) -> dict[int, str]:
    """Return the reasons of the runs that failed, by their places from ``first`` on."""
    return {run: why for run, why in enumerate(failure.tolist(), first) if why}


@dataclass(frozen=True)
class _Read(Mapping[str, Array]):
    """Datasets that are read when they are used first."""

    names: set[str]
    load: Callable[[str], Array]
    there: dict[str, Array] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Array:
        if name not in self.names:
            raise KeyError(name)
        if name not in self.there:
            self.there[name] = self.load(name)
        return self.there[name]

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self.names))

    def __len__(self) -> int:
        return len(self.names)
