"""What has to run, and why: derived from the scenario and from the files alone."""

import hashlib
import json
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from debrisest.errors import UserError
from debrisest.results import store
from debrisest.run.stages.pipeline import STAGES, stages_of
from debrisest.scenario.case import Case
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.mistakes import allowed_names

RUNS_PER_FILE = 20
SIMULATED = "-"
"""Stands for the estimator in cells of what was simulated; no estimator can have this name."""


@dataclass(frozen=True)
class Step:
    """One stage of one chunk of runs: reads its upstream files, writes its own."""

    case: Case
    estimator: str
    stage: str
    first_run: int
    runs: int
    path: Path
    upstream: tuple["Step", ...]
    inputs: dict[str, Any]
    key: str
    reason: str
    """Why it has to run; empty where its file is up to date."""
    notice: str = ""
    """What the user should know about the file that is replaced."""

    @property
    def name(self) -> str:
        """Return what this step is called in messages."""
        estimator = f" {self.estimator}" if self.estimator else ""
        last = self.first_run + self.runs - 1
        return (
            f"{self.case.scenario_name} {self.case.name}: {self.stage}{estimator}, "
            f"runs {self.first_run}-{last}"
        )


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
        folder = out / scenario.name / name
        wanted = case.runs(selection.runs)
        for first in range(0, wanted, RUNS_PER_FILE):
            chunk = _Chunk(case, folder, first, min(RUNS_PER_FILE, wanted - first), selection)
            steps += chunk.steps(estimators)
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
    if problems:
        raise UserError(problems)


@dataclass(frozen=True)
class _Chunk:
    """Some runs of a case, and where their files lie."""

    case: Case
    folder: Path
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
        key = _key(inputs, [step.key for step in upstream])
        name = f"{stage}-{estimator}" if estimator else stage
        path = self.folder / f"{name}.{self.first:06d}.h5"
        found = store.inspect(path)
        reason, notice = self._why(path, found, key, inputs, upstream)
        held = found.attributes.get("runs", 0) if found.attributes.get("stage_key") == key else 0
        self.held.append(held if reason else 0)
        return Step(
            self.case,
            estimator,
            stage,
            self.first,
            self.runs,
            path,
            upstream,
            inputs,
            key,
            reason,
            notice,
        )

    def _why(
        self,
        path: Path,
        found: store.Checkpoint,
        key: str,
        inputs: dict[str, Any],
        upstream: tuple[Step, ...],
    ) -> tuple[str, str]:
        """Return why the step has to run, and a notice where a file is given up for it."""
        if found.condition is store.Condition.FOREIGN:
            raise UserError(
                f"{path} is {found.condition.value}; "
                "move it away or choose another folder with --out"
            )
        if found.condition is store.Condition.MISSING:
            return "not there yet", ""
        if found.condition is not store.Condition.WHOLE:
            return f"its file is {found.condition.value}", (
                f"{path} is {found.condition.value}: it is computed again"
            )
        if self.selection.force:
            return "asked for by --force", ""
        before = [step for step in upstream if step.reason]
        if before:
            return f"{before[0].stage} runs before it", ""
        if found.attributes.get("stage_key") != key:
            return _difference(json.loads(found.attributes["inputs"]), inputs), ""
        if found.attributes["runs"] < self.runs:
            return f"holds {found.attributes['runs']} runs, {self.runs} are wanted", ""
        return "", ""


def _within(stage: str, last: str) -> bool:
    order = list(STAGES)
    return order.index(stage) <= order.index(last)


def _key(inputs: dict[str, Any], upstream: list[str]) -> str:
    """Hash inputs in their order, since the order of features and of sensors matters."""
    return hashlib.sha256(json.dumps([inputs, upstream]).encode()).hexdigest()


def _difference(before: dict[str, Any], now: dict[str, Any]) -> str:
    """Return the first keys whose values differ, with both values."""
    was, now_is = _flat(before), _flat(now)
    changed = [key for key in was | now_is if was.get(key) != now_is.get(key)]
    if not changed and list(was) != list(now_is):
        return "the order of its parts changed"
    if not changed:
        return "an earlier stage was computed anew"
    told = [f"{key} was {was.get(key)}, is {now_is.get(key)}" for key in changed[:3]]
    return "; ".join(told) + ("; ..." if len(changed) > 3 else "")


def _flat(value: Any, prefix: str = "") -> dict[str, Any]:
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = {str(index): item for index, item in enumerate(value)}.items()
    else:
        return {prefix: value}
    return {
        path: leaf
        for key, item in items
        for path, leaf in _flat(item, f"{prefix}.{key}" if prefix else str(key)).items()
    }
