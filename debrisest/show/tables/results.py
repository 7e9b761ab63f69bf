"""The assessed errors of a scenario, as far as they are there and up to date."""

from collections.abc import Container, Iterable
from typing import NamedTuple

import numpy as np

from debrisest.arrays import Array, BoolArray, Data
from debrisest.assessment.consistency import dof_of_runs
from debrisest.assessment.statistics import per_run, window_mask
from debrisest.results import store
from debrisest.run.plan import SIMULATED, Step
from debrisest.scenario.schema import Divergence, window_of
from debrisest.vocabulary import VOCABULARY, table_scale


class Result(NamedTuple):
    """All runs of one case and estimator: errors by quantity in SI, and the reasons of failures.

    What was simulated takes the place of errors where the estimator is SIMULATED.
    """

    errors: Data
    times: Array
    duration: float
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
        inside = window_mask(self.times, window_of(window, self.duration))
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
        inside = window_mask(self.times, window_of(window, self.duration))
        return np.nan_to_num(self.errors[law.freedom][:, inside])

    def diverged(self, rules: Iterable[Divergence]) -> BoolArray:
        """Return which runs (run,) broke one of the rules."""
        lost = np.zeros(self.runs, dtype=bool)
        for rule in rules:
            if rule.quantity in self.errors:
                lost |= ~(self.figures(rule.quantity, rule.statistic, rule.window) <= rule.above)
        return lost & self.good


def load_results(
    steps: Iterable[Step], simulated: Iterable[str] = ()
) -> dict[tuple[str, str], Result]:
    """Return the results by (case, estimator) of which every chunk is up to date.

    The datasets ``simulated`` of the simulations come under the estimator SIMULATED.
    """
    wanted = {"run", "time_s", "failure", *simulated}
    chunks: dict[tuple[str, str], list[Step]] = {}
    for step in steps:
        if step.stage == "assess":
            chunks.setdefault((step.case.name, step.estimator), []).append(step)
        elif step.stage == "simulate" and simulated:
            chunks.setdefault((step.case.name, SIMULATED), []).append(step)
    return {
        key: _joined(parts, wanted if key[1] == SIMULATED else VOCABULARY)
        for key, parts in chunks.items()
        if not any(step.reason for step in parts)
    }


def _joined(steps: list[Step], names: Container[str]) -> Result:
    parts = [store.read(step.path, step.runs, names) for step in steps]
    runs = sum(step.runs for step in steps)
    reasons = [str(why) for part in parts for why in part["failure"]]
    names = {name for part in parts for name in part} - {"run", "time_s", "failure"}
    return Result(
        errors={name: _concatenated(name, parts) for name in sorted(names)},
        times=parts[0]["time_s"],
        duration=steps[0].case.scenario.duration_s,
        failures={run: why for run, why in enumerate(reasons) if why},
        runs=runs,
    )


def _concatenated(name: str, parts: list[Data]) -> Array:
    shape = next(part[name].shape[1:] for part in parts if name in part)
    return np.concatenate(
        [part.get(name, np.full((len(part["run"]), *shape), np.nan)) for part in parts]
    )
