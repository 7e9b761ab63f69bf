"""What tables ask of all runs of one case and estimator."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping

import numpy as np

from debrisest.arrays import Array, BoolArray
from debrisest.scenario.table_keys import Divergence

SIMULATED = "-"
"""Stands for the estimator in cells of what was simulated; no estimator can have this name."""


class Runs(ABC):
    """Figures of all runs of one case and estimator, and the reasons of failures."""

    failures: Mapping[int, str]
    runs: int

    @abstractmethod
    def has(self, dataset: str) -> bool:
        """Return whether any run has a dataset."""

    @abstractmethod
    def figures(self, dataset: str, statistic: str, window: str) -> Array:
        """Return one figure per run (run,), in the unit of the tables; NaN where it failed."""

    @abstractmethod
    def freedom(self, dataset: str, statistic: str, window: str) -> Array:
        """Return the degrees of freedom of each figure (run,), 0 where it is no chi-square."""

    @abstractmethod
    def seen(self, dataset: str, window: str) -> bool:
        """Return whether any run can have a figure: with degrees of freedom, if it needs some."""

    def shows(self, dataset: str) -> bool:
        """Return whether there is a figure, or would be one if not all runs had failed."""
        return self.has(dataset) or len(self.failures) == self.runs

    @property
    def good(self) -> BoolArray:
        """Return which runs (run,) gave a result."""
        return np.array([run not in self.failures for run in range(self.runs)], dtype=bool)

    def diverged(self, rules: Iterable[Divergence]) -> BoolArray:
        """Return which runs (run,) broke one of the rules."""
        lost = np.zeros(self.runs, dtype=bool)
        for rule in rules:
            if self.has(rule.quantity):
                lost |= ~(self.figures(rule.quantity, rule.statistic, rule.window) <= rule.above)
        return lost & self.good
