"""What has to run, and why: derived from the scenario and from the files alone."""

import hashlib
import json
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from debrisest.errors import UserError, allowed_names
from debrisest.results import store
from debrisest.results.address import Address
from debrisest.results.assessed import SIMULATED
from debrisest.results.status import Wanted, out_of_date
from debrisest.runner.stages.pipeline import STAGES, stages_of
from debrisest.scenario.case import Case
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.schema import MOST_RUNS

RUNS_PER_FILE = 20


@dataclass(frozen=True, kw_only=True)
class Step(Wanted):
    """One stage of one chunk of runs: reads its upstream files, writes its own."""

    case: Case
    upstream: tuple["Step", ...]

    @property
    def kin(self) -> tuple[str, ...]:
        """Return what steps have in common that differ in their runs alone."""
        return self.address[:-1]

    @property
    def together(self) -> int:
        """Return how many of them are best computed in one call."""
        runs = STAGES[self.address.stage].runs_together(self.case, self.address.estimator)
        return max(1, runs // RUNS_PER_FILE)


@dataclass(frozen=True)
class Selection:
    """Which part of a scenario is asked for; None is all."""

    runs: int | None = None
    cases: Sequence[str] | None = None
    estimators: Sequence[str] | None = None
    last_stage: str = "assess"
    force: bool = False

    def asks_for(self, case: str, estimator: str, means: Container[str]) -> bool:
        """Return whether a cell belongs to it; means belong to a selection of all cases."""
        case_fits = self.cases is None or (case in self.cases and case not in means)
        if estimator == SIMULATED or self.estimators is None:
            return case_fits
        return case_fits and estimator in self.estimators


def plan(scenario: LoadedScenario, out: Path, selection: Selection) -> list[Step]:
    """Return every step that the selection needs, upstream first, with the reasons to run."""
    cases = [name for name in scenario.cases if name in (selection.cases or scenario.cases)]
    steps: list[Step] = []
    for name in cases:
        case = scenario.cases[name]
        wanted_of = selection.estimators or case.estimators
        estimators = [one for one in case.estimators if one in wanted_of]
        wanted = case.runs(selection.runs)
        chunks = [
            _Chunk(case, out, first, min(RUNS_PER_FILE, wanted - first), selection)
            for first in range(0, wanted, RUNS_PER_FILE)
        ]
        by_stage = zip(*(chunk.steps(estimators) for chunk in chunks), strict=True)
        steps += [step for stage in by_stage for step in stage]
    return steps


def check_selection(scenarios: Sequence[LoadedScenario], selection: Selection) -> None:
    """Raise UserError for a name that is asked for and that no scenario has."""
    cases = [name for scenario in scenarios for name in scenario.cases]
    estimators = [name for scenario in scenarios for name in scenario.common.estimators]
    asked = (("case", selection.cases, cases), ("estimator", selection.estimators, estimators))
    problems = [
        f"--{what} {name}: unknown {what}; {allowed_names(name, dict.fromkeys(known))}"
        for what, names, known in asked
        for name in names or []
        if name not in known
    ]
    if selection.runs is not None and not 1 <= selection.runs <= MOST_RUNS:
        problems.append(f"--runs {selection.runs}: from 1 to {MOST_RUNS} are possible")
    if problems:
        raise UserError(problems)


@dataclass(frozen=True)
class _Chunk:
    """Some runs of a case, and the folder that their files go to."""

    case: Case
    out: Path
    first: int
    runs: int
    selection: Selection
    held: list[int] = field(default_factory=list)
    """Runs of the files of this very scenario that have to be computed anew all the same."""

    def steps(self, estimators: Sequence[str]) -> list[Step]:
        """Return the steps; what is computed anew keeps as many runs as its file held."""
        simulate = self._step("simulate", "", ())
        steps = [simulate, *self._estimator_steps(simulate, estimators)]
        most = max(self.runs, *self.held)
        return [replace(step, runs=most) if step.reason else step for step in steps]

    def _estimator_steps(self, simulate: Step, estimators: Sequence[str]) -> Iterator[Step]:
        for estimator in estimators:
            done: tuple[Step, ...] = (simulate,)
            names = stages_of(self.case, estimator)
            for stage in names:
                if not _within(stage, self.selection.last_stage):
                    break
                done = (*done, self._step(stage, estimator, done))
            yield from done[1:]

    def _step(self, stage: str, estimator: str, upstream: tuple[Step, ...]) -> Step:
        inputs = STAGES[stage].inputs(self.case, estimator)
        address = Address(self.case.scenario_name, self.case.name, stage, estimator, self.first)
        step = Step(
            case=self.case,
            upstream=upstream,
            address=address,
            path=address.path(self.out),
            runs=self.runs,
            inputs=inputs,
            key=_key(inputs, [step.key for step in upstream]),
        )
        found = store.inspect(step.path, store.Depth.BYTES)
        reason, notice = out_of_date(step, found, self._asked_for(upstream))
        same = store.fits(found.attributes, step.attributes)
        self.held.append(found.attributes.get("runs", 0) if same and reason else 0)
        return replace(step, reason=reason, notice=notice)

    def _asked_for(self, upstream: tuple[Step, ...]) -> str:
        """Return why a step runs whatever its file holds."""
        before = [f"{step.address.stage} runs before it" for step in upstream if step.reason]
        return "asked for by --force" if self.selection.force else "".join(before[:1])


def _within(stage: str, last: str) -> bool:
    order = list(STAGES)
    return order.index(stage) <= order.index(last)


def _key(inputs: dict[str, Any], upstream: list[str]) -> str:
    """Hash inputs in their order, since the order of features and of sensors matters."""
    return hashlib.sha256(json.dumps([inputs, upstream]).encode()).hexdigest()
