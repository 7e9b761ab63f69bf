"""The results of a scenario: what is there, its data, and the runs that failed."""

import sys
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from debrisest.arrays import Data
from debrisest.errors import UserError, allowed_names
from debrisest.results import store
from debrisest.results.address import STAGES, Address
from debrisest.results.chunk import Chunk
from debrisest.results.failures import Failure, failures_of
from debrisest.results.joined import joined
from debrisest.scenario.document import parse
from debrisest.vocabulary import VOCABULARY, has_runs

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, repr=False)
class Results:
    """The whole files of results of a scenario.

    Points of a grid that are one truth have one simulation, whose data each of them shows.
    The estimator is empty where the simulation is meant, which all estimators of a case share.
    """

    folder: Path
    chunks: tuple[Chunk, ...]
    left_out: list[str]
    """The files of the folder that are damaged or foreign, in sentences."""

    def __repr__(self) -> str:
        told = f"{len(self.cases)} cases, {len(self.chunks)} files, {len(self.left_out)} left out"
        return f"<results of {self.folder}: {told}>"

    @property
    def cases(self) -> list[str]:
        """Return the names of the cases; a simulation that these share is none by itself."""
        estimated = {one.address.case for one in self.chunks if one.address.estimator}
        shared = {self.simulation(case) for case in estimated} - estimated
        return [case for case in self._every if case not in shared]

    @property
    def _every(self) -> list[str]:
        """Return the names of the cases, and of simulations that they share."""
        return list(dict.fromkeys(chunk.address.case for chunk in self.chunks))

    def simulation(self, case: str) -> str:
        """Return the case in whose name the simulation of a case is kept: by default its own."""
        own = (one for one in self.chunks if one.address.case == case and one.address.estimator)
        told = [str(one.attributes.get("simulation", case)) for one in own]
        return told[-1] if told else case

    def estimators(self, case: str) -> list[str]:
        """Return the names of the estimators of a case."""
        own = (one.address.estimator for one in self.chunks if one.address.case == case)
        return [name for name in dict.fromkeys(own) if name]

    def stages(self, case: str, estimator: str = "") -> list[str]:
        """Return the stages of an estimator that there are, in their order."""
        return [stage for stage in STAGES if self._of_stage(case, estimator, stage)]

    def runs(self, case: str, estimator: str, stage: str) -> int:
        """Return how many runs there are of a stage."""
        return sum(chunk.runs for chunk in self._of_stage(case, estimator, stage))

    def limited(self, runs: Mapping[Address, int]) -> "Results":
        """Return only the files at some addresses, in their order, of each only so many runs."""
        there = {chunk.address: chunk for chunk in self.chunks}
        kept = [(there[address], most) for address, most in runs.items() if address in there]
        chunks = tuple(chunk._replace(runs=min(most, chunk.runs)) for chunk, most in kept)
        return replace(self, chunks=chunks)

    def load(
        self,
        case: str,
        estimator: str = "",
        stage: str = "",
        names: Container[str] = VOCABULARY,
        runs: int | None = None,
    ) -> Data:
        """Return the datasets of a stage, by default of the last, of the runs before ``runs``.

        They are in SI and radians, with axes as in the vocabulary; NaN where trajectories are not
        kept. Raises UserError for what is not there.
        """
        most = sys.maxsize if runs is None else runs
        wanted = [
            (chunk, most - chunk.address.first_run)
            for chunk in self._chosen(case, estimator, stage)
            if chunk.address.first_run < most
        ]
        counts = [min(chunk.runs, last) for chunk, last in wanted]
        return joined((chunk.read(names, runs=last) for chunk, last in wanted), counts)

    def parts(
        self,
        case: str,
        estimator: str = "",
        stage: str = "",
        names: Container[str] = VOCABULARY,
    ) -> Iterator[Data]:
        """Yield the datasets of one file of a stage after the other, as ``load`` does of all."""
        for chunk in self._chosen(case, estimator, stage):
            yield chunk.read(names)

    def datasets(self, case: str, estimator: str, stage: str) -> set[str]:
        """Return the names of the datasets of a stage."""
        return set().union(*(chunk.datasets for chunk in self._chosen(case, estimator, stage)))

    def datasets_of_run(self, case: str, estimator: str, run: int) -> set[str]:
        """Return the names of those that ``one_run`` returns."""
        places = ((one, run - one.address.first_run) for one in self._of_run(case, estimator))
        return set().union(*(one.datasets_of_run(at) for one, at in places if 0 <= at < one.runs))

    def dataset(self, case: str, estimator: str = "", stage: str = "") -> "xarray.Dataset":
        """Return what ``load`` does as an xarray Dataset with coordinates, units and names."""
        from debrisest.results.labelled import labelled

        first = self._chosen(case, estimator, stage)[0]
        return labelled(self.load(case, estimator, stage), store.frames(first.path))

    def scenario(self, case: str) -> dict[str, Any]:
        """Return the resolved scenario of a case, as the last of its files has it."""
        self._check("case", case, self._every)
        own = [chunk for chunk in self.chunks if chunk.address.case == case]
        last = max(own, key=lambda chunk: str(chunk.attributes["created"]))
        return parse(last.attributes["scenario"], f"{last.path}, scenario")[0].value

    def failures(self, case: str | None = None, estimator: str | None = None) -> list[Failure]:
        """Return the runs that gave no result, by default of all cases and estimators."""
        return failures_of(self._of_run(case, estimator))

    def good_runs(self, case: str, estimator: str = "") -> set[int]:
        """Return the numbers of the runs of which no stage failed."""
        there = {
            chunk.address.first_run + index
            for chunk in self._of_run(case, estimator)
            for index in range(chunk.runs)
        }
        return there - {failure.run for failure in self.failures(case, estimator)}

    def first_good_run(self, case: str, estimator: str = "") -> int | None:
        """Return the number of the first run of which no stage failed, if there is one."""
        return min(self.good_runs(case, estimator), default=None)

    def one_run(self, case: str, estimator: str, run: int) -> Data:
        """Return a run's datasets of all stages without their run axis; of one name, the latest.

        Trajectories that are not kept are left out.
        """
        data: Data = {}
        for chunk in self._of_run(case, estimator):
            index = run - chunk.address.first_run
            if 0 <= index < chunk.runs:
                data |= chunk.read_run(index)
        return {name: value[0] if has_runs(name) else value for name, value in data.items()}

    def is_whole(self, case: str, estimator: str, run: int) -> bool:
        """Return whether the trajectories of a run are kept in all files that there are of it."""
        places = ((one, run - one.address.first_run) for one in self._of_run(case, estimator))
        return all(one.is_whole(at) for one, at in places if 0 <= at < one.runs)

    def not_kept(self, case: str, estimator: str, run: int) -> str:
        """Return what to do for the trajectories of a run, which are not kept."""
        of = f"{self.folder.name} {case}: {estimator}, run {run}"
        return f"the trajectories of {of} are not kept; sweep with --keep all or --keep {run + 1}"

    def _of_run(self, case: str | None, estimator: str | None) -> Iterator[Chunk]:
        """Yield the files that a run of an estimator comes from; None stands for all of them."""
        simulation = None if case is None else self.simulation(case)
        for chunk in self.chunks:
            of = chunk.address
            wanted = case if of.estimator else simulation
            if wanted in (None, of.case) and (estimator is None or of.estimator in ("", estimator)):
                yield chunk

    def _chosen(self, case: str, estimator: str, stage: str) -> list[Chunk]:
        """Return the files of a stage, by default the last; raise UserError if there is none."""
        self._check("case", case, self._every)
        self._check("estimator", estimator, ["", *self.estimators(case)])
        there = self.stages(case, estimator)
        wanted = stage or (there[-1] if there else STAGES[0])
        self._check("stage", wanted, there)
        return self._of_stage(case, estimator, wanted)

    def _of_stage(self, case: str, estimator: str, stage: str) -> list[Chunk]:
        wanted = (case if estimator else self.simulation(case), stage, estimator)
        return [chunk for chunk in self.chunks if chunk.address[1:4] == wanted]

    def _check(self, what: str, name: str, known: list[str]) -> None:
        """Raise UserError for a name that there is not."""
        if name not in known:
            there = allowed_names(name, filter(None, known)).replace("allowed", "there", 1)
            raise UserError(f"{self.folder}: no {what} {name!r}; {there}")
