"""One experiment of a scenario file."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np

from debrisest.arrays import Data, IntArray
from debrisest.clock import Clock
from debrisest.errors import UserError
from debrisest.plugins.load import Plugin, load_plugins
from debrisest.roles import SourcePart
from debrisest.scenario.models import scenario_model
from debrisest.scenario.schema import Scenario
from debrisest.vocabulary import has_runs


@dataclass(frozen=True)
class Case:
    """A scenario with the case's changes and the overrides laid on it.

    Only plain data travels to other processes; the scenario is validated again where it is used.
    """

    scenario_name: str
    name: str
    document: dict[str, Any]
    folder: Path
    """From which the paths of files in the scenario count."""
    plugins: tuple[Plugin, ...] = ()
    simulated_as: str = ""
    """The name of its simulation, which points of a grid may share; empty: its own."""

    @cached_property
    def scenario(self) -> Scenario:
        """Return the validated scenario of this case."""
        load_plugins(self.plugins)
        scenario: Scenario = scenario_model().model_validate(
            self.document, context={"folder": self.folder}
        )
        return scenario

    def known_as(self, scenario: Scenario) -> Self:
        """Return the case, which takes a scenario for the one that its document was found to be."""
        vars(self)["scenario"] = scenario
        return self

    @property
    def simulation(self) -> Self:
        """Return the case as its simulation is called."""
        own = replace(self, name=self.simulated_as or self.name, simulated_as="")
        return own.known_as(self.scenario)

    @property
    def draws(self) -> str:
        """Return the name that the draws of its runs are bound to."""
        return self.scenario.draws or self.simulated_as or self.name

    @cached_property
    def measured(self) -> Data:
        """Return what the files of a measured scenario hold; nothing for a simulated one."""
        source, before = self.scenario.measured, self.measured_digest
        data = {} if source is None else source.read(self.folder)
        if source is not None and source.digest(self.folder) != before:
            told = ", ".join(str(self.folder / name) for name in source.files)
            raise UserError(f"{told or self.folder}: this changed while it was read; run again")
        return data

    @cached_property
    def measured_digest(self) -> str:
        """Return the checksum of these files, taken before they are read."""
        source = self.scenario.measured
        return "" if source is None else source.digest(self.folder)

    @property
    def source(self) -> SourcePart | None:
        """Return where measured data come from, in the place of a simulation."""
        return self.scenario.measured

    @property
    def clock(self) -> Clock:
        """Return the epochs."""
        return Clock(self.measured["time_s"]) if self.source else self.scenario.clock

    @property
    def estimators(self) -> list[str]:
        """Return the estimators that are used in this case."""
        every = self.scenario.estimators.items()
        return [name for name, one in every if one.cases is None or self.name in one.cases]

    def runs(self, wanted: int | None) -> int:
        """Return how many runs there are to be, of measured data no more than there are."""
        runs = self.scenario.runs
        return min(wanted or runs, runs) if self.source else wanted or runs

    def measured_runs(self, runs: IntArray) -> Data:
        """Return the measured data of some runs."""
        data = {name: v[runs] if has_runs(name) else v for name, v in self.measured.items()}
        return {name: np.asarray(value) for name, value in data.items()}

    def __getstate__(self) -> dict[str, Any]:
        found_here = ("scenario", "measured", "measured_digest")
        return {key: v for key, v in self.__dict__.items() if key not in found_here}
