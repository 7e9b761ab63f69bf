"""The errors of all runs of one case and estimator, and the figures that tables make of them."""

from collections.abc import Collection, Iterable, Mapping
from typing import NamedTuple, TypeAlias

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.assessment.consistency import dof_of_runs
from debrisest.assessment.statistics import per_run, window_mask
from debrisest.results.results import Results
from debrisest.scenario.table_keys import Divergence
from debrisest.scenario.window import window_of
from debrisest.vocabulary import VOCABULARY, table_scale

SIMULATED = "-"
"""Stands for the estimator in cells of what was simulated; no estimator can have this name."""

_OF_FILES = {"run", "time_s", "failure"}
"""What every file holds beside its own datasets."""


class Result(NamedTuple):
    """All runs of one case and estimator: errors by quantity in SI, and the reasons of failures.

    What was simulated takes the place of errors where the estimator is SIMULATED.
    """

    errors: Data
    times: Array
    failures: dict[int, str]
    runs: int

    def shows(self, dataset: str) -> bool:
        """Return whether there is a figure, or would be one if not all runs had failed."""
        return dataset in self.errors or len(self.failures) == self.runs

    @property
    def good(self) -> BoolArray:
        """Return which runs (run,) gave a result."""
        return np.array([run not in self.failures for run in range(self.runs)], dtype=bool)

    def figures(self, dataset: str, statistic: str, window: str) -> Array:
        """Return one figure per run (run,), in the unit of the tables; NaN where it failed."""
        if dataset not in self.errors:
            return np.full(self.runs, np.nan)
        inside = window_mask(self.times, window_of(window, float(self.times[-1])))
        return per_run(statistic, self.errors[dataset], inside) * table_scale(dataset)

    def freedom(self, dataset: str, statistic: str, window: str) -> Array:
        """Return the degrees of freedom of each figure (run,), 0 where it is no chi-square."""
        degrees = self._degrees(dataset, window)
        law = VOCABULARY[dataset].chi_square
        if degrees is None or law is None:
            return np.zeros(self.runs)
        return dof_of_runs(statistic, degrees, law.white)

    def seen(self, dataset: str, window: str) -> bool:
        """Return whether any run can have a figure: with degrees of freedom, if it needs some."""
        degrees = self._degrees(dataset, window)
        return degrees is None or bool((degrees > 0).any())

    def _degrees(self, dataset: str, window: str) -> Array | None:
        """Return the degrees of freedom of each epoch (run, epoch) of a window, where there are."""
        law = VOCABULARY[dataset].chi_square
        if law is None or law.freedom not in self.errors:
            return None
        inside = window_mask(self.times, window_of(window, float(self.times[-1])))
        return np.nan_to_num(self.errors[law.freedom][:, inside])

    def diverged(self, rules: Iterable[Divergence]) -> BoolArray:
        """Return which runs (run,) broke one of the rules."""
        lost = np.zeros(self.runs, dtype=bool)
        for rule in rules:
            if rule.quantity in self.errors:
                lost |= ~(self.figures(rule.quantity, rule.statistic, rule.window) <= rule.above)
        return lost & self.good


Assessed: TypeAlias = Mapping[tuple[str, str], Result]
"""Results by case and estimator."""


def assessed(
    results: Results, simulated: Collection[str] = (), names: Collection[str] = VOCABULARY
) -> dict[tuple[str, str], Result]:
    """Return what was assessed of the named quantities, by case and estimator.

    The datasets ``simulated`` of the simulations come under the estimator SIMULATED.
    """
    laws = (VOCABULARY[name].chi_square for name in names)
    wanted = {*_OF_FILES, *names, *(law.freedom for law in laws if law is not None)}
    found: dict[tuple[str, str], Result] = {}
    for case in results.cases:
        if simulated and results.stages(case):
            found[case, SIMULATED] = _result(results.load(case, names={*_OF_FILES, *simulated}))
        for estimator in results.estimators(case):
            if "assess" in results.stages(case, estimator):
                found[case, estimator] = _result(results.load(case, estimator, "assess", wanted))
    return found


def _result(data: Data) -> Result:
    failures = {run: why for run, why in enumerate(data["failure"].tolist()) if why}
    errors = {name: values for name, values in data.items() if name not in _OF_FILES}
    return Result(errors, data["time_s"], failures, len(data["run"]))
