"""What has to run, and why: derived from the scenario and from the files alone."""

import hashlib
import json
from collections.abc import Container, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from typing import Any

from debrisest.results import store
from debrisest.results.address import Address
from debrisest.results.status import out_of_date
from debrisest.runner.cut import cut
from debrisest.runner.selection import Selection
from debrisest.runner.stages.pipeline import STAGES, stages_of
from debrisest.runner.step import Step
from debrisest.runner.taken_over import same_file, variants_beside
from debrisest.scenario.case import Case
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.resolved import resolved


def plan(
    scenario: LoadedScenario,
    out: Path,
    selection: Selection,
    verified: Container[str] = (),
) -> list[Step]:
    """Return every step that the selection needs, upstream first, with the reasons to run.

    A simulation that points of a grid share is one step. What another variant has already is told.
    Labels and lengths of files are looked at, and all bytes of the stages that are ``verified``:
    whoever reads data verifies them then.
    """
    cases = [name for name in scenario.cases if name in (selection.cases or scenario.cases)]
    beside = variants_beside(out, scenario.name)
    steps: list[Step] = []
    for name in cases:
        case = scenario.cases[name]
        wanted_of = selection.estimators or case.estimators
        estimators = [one for one in case.estimators if one in wanted_of]
        planned = _Planned(case, out, beside, selection, verified)
        steps += planned.steps(estimators, case.runs(selection.runs))
    return _once(steps)


def _once(steps: Sequence[Step]) -> list[Step]:
    """Return one step for each file, with the most runs that any case wants of it."""
    found: dict[Path, Step] = {}
    for step in steps:
        found[step.path] = max(found.get(step.path, step), step, key=lambda one: one.runs)
    return list(found.values())


@dataclass(frozen=True)
class _Planned:
    """A case, and the folder that its files go to."""

    case: Case
    out: Path
    beside: Sequence[str]
    """The folders of other variants of the scenario."""
    selection: Selection
    verified: Container[str]
    held: dict[Path, int] = field(default_factory=dict)
    """Runs of the files of this very scenario that have to be computed anew all the same."""
    whole: dict[Path, int] = field(default_factory=dict)
    """How many runs of each file that is there have their trajectories."""
    growing: set[Path] = field(default_factory=set)
    """Files of which nothing is computed anew but runs that they lack."""
    known: dict[tuple[str, ...], tuple[dict[str, Any], str]] = field(default_factory=dict)
    """Inputs and key of each stage."""

    def steps(self, estimators: Sequence[str], runs: int) -> list[Step]:
        """Return the steps of so many runs, stage by stage."""
        simulated = [self._step("simulate", "", (), *share) for share in cut(self.case, "", runs)]
        after: list[Step] = []
        for estimator in estimators:
            chains = [
                self._anew([*self._chain(estimator, simulated, *share)])
                for share in cut(self.case, estimator, runs)
            ]
            after += [step for stage in zip(*chains, strict=True) for step in stage]
        return [*self._simulations(simulated, after), *after]

    def _simulations(self, simulated: Sequence[Step], after: Sequence[Step]) -> Iterator[Step]:
        """Yield the simulations, each of as many runs as what comes after it is computed of."""
        for step in simulated:
            ends = (one.end for one in after if one.upstream[0].path == step.path and one.reason)
            most = max((step.end, *ends)) - step.address.first_run
            yield from self._anew([step], most)

    def _anew(self, steps: list[Step], most: int = 0) -> list[Step]:
        """Return steps of the same runs; what is computed anew keeps as many as its file held."""
        most = max([most, *(max(step.runs, self.held[step.path]) for step in steps)])
        anew = [
            replace(step, runs=most, same=step.same if most == step.runs else None)
            if step.reason
            else step
            for step in steps
        ]
        return _paired(anew)

    def _chain(
        self, estimator: str, simulated: Sequence[Step], first: int, runs: int
    ) -> Iterator[Step]:
        """Yield the steps of an estimator for some runs."""
        simulation = next(one for one in reversed(simulated) if one.address.first_run <= first)
        done: tuple[Step, ...] = (simulation,)
        for stage in stages_of(self.case, estimator):
            if not _within(stage, self.selection.last_stage):
                break
            done = (*done, self._step(stage, estimator, done, first, runs))
            if stage == "assess" and done[-1].is_due:
                done = self._with_trajectories(done)
        yield from done[1:]

    def _with_trajectories(self, done: tuple[Step, ...]) -> tuple[Step, ...]:
        """Return the steps, with the filter due if its file lacks what the last one reads."""
        *before, filtered, assess = done
        known = filtered.is_due or filtered.address.stage != "filter"
        if known or (not filtered.same and self.whole[filtered.path] >= filtered.runs):
            return done
        why = filtered.reason or f"{assess.address.stage} needs its trajectories"
        filtered = replace(filtered, reason=why, same=None)
        return (*before, filtered, replace(assess, upstream=(*before, filtered)))

    def _step(
        self, stage: str, estimator: str, upstream: tuple[Step, ...], first: int, runs: int
    ) -> Step:
        case = self.case if upstream else self.case.simulation
        inputs, key = self._told_of(stage, estimator, case, tuple(step.key for step in upstream))
        address = Address(case.scenario_name, case.name, stage, estimator, first)
        step = Step(
            case=case,
            upstream=upstream,
            address=address,
            path=address.path(self.out),
            runs=runs,
            whole_runs=min(runs, max(0, self.case.scenario.whole_runs - first)),
            inputs=inputs,
            key=key,
        )
        depth = store.Depth.BYTES if stage in self.verified else store.Depth.LABEL
        found = store.inspect(step.path, depth)
        asked = self._asked_for(address, upstream)
        reason, notice = out_of_date(step, found, asked)
        same = store.fits(found.attributes, step.attributes)
        self.whole[step.path] = found.attributes.get("whole_runs", runs)
        self.held[step.path] = held = found.attributes.get("runs", 0) if same and reason else 0
        if not (asked or notice) and 0 < held < runs:
            self.growing.add(step.path)
        there = reason and not asked and not notice
        other = same_file(step, self.out, self.beside, depth, self._told) if there else None
        return replace(step, reason=reason, notice=notice, same=other)

    def _told_of(
        self, stage: str, estimator: str, case: Case, upstream: tuple[str, ...]
    ) -> tuple[dict[str, Any], str]:
        """Return the inputs and the key that all files of a stage have."""
        of = (stage, estimator, *upstream)
        if of not in self.known:
            inputs = STAGES[stage].inputs(case, estimator)
            self.known[of] = inputs, _key(inputs, upstream)
        return self.known[of]

    @cached_property
    def _told(self) -> str:
        return resolved(self.case) if self.beside else ""

    def _asked_for(self, address: Address, upstream: tuple[Step, ...]) -> str:
        """Return why a step runs whatever its file holds."""
        if self.selection.force:
            return "asked for by --force"
        if address in self.selection.again:
            return "a run of it failed or diverged"
        due = (step for step in upstream if step.is_due and step.path not in self.growing)
        return next((f"{step.address.stage} runs before it" for step in due), "")


def _paired(steps: list[Step]) -> list[Step]:
    """Return the steps, each filter with what assesses it where both are due."""
    pairs = list(steps)
    for index, (filtered, assess) in enumerate(pairwise(steps)):
        both = (filtered.address.stage, assess.address.stage) == ("filter", "assess")
        if both and filtered.is_due and assess.is_due:
            pairs[index + 1] = replace(assess, computed_before=True)
            pairs[index] = replace(filtered, then=pairs[index + 1])
    return pairs


def _within(stage: str, last: str) -> bool:
    order = list(STAGES)
    return order.index(stage) <= order.index(last)


def _key(inputs: dict[str, Any], upstream: Sequence[str]) -> str:
    """Hash inputs in their order, since the order of features and of sensors matters."""
    return hashlib.sha256(json.dumps([inputs, upstream]).encode()).hexdigest()
