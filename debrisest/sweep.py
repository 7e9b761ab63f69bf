"""Bring scenarios up to date: plan, run what has a reason to run, tell what happened."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from debrisest import store
from debrisest.execute import execute, executor, failures_of
from debrisest.plan import Selection, Step, plan
from debrisest.progress import Progress, progress
from debrisest.scenario.load import LoadedScenario
from debrisest.tables.cells import cells, write_csv
from debrisest.tables.render import render
from debrisest.tables.results import load_results


@dataclass(frozen=True)
class Machine:
    """Where steps are computed."""

    jobs: int = 1
    cluster: str | None = None
    quiet: bool = False


def bring_up_to_date(
    scenarios: Sequence[LoadedScenario], out: Path, selection: Selection, machine: Machine
) -> dict[str, str]:
    """Run every step that has a reason to; return the runs that gave no result, with reasons."""
    for scenario in scenarios:
        store.remove_leftovers(out / scenario.name)
    steps = [step for scenario in scenarios for step in plan(scenario, out, selection)]
    due = [step for step in steps if step.reason]
    with progress(len(due), machine.quiet) as told:
        for step in due:
            if step.notice:
                told.say(step.notice)
        if due:
            _run(steps, machine, told)
    return _failures(steps)


def _run(steps: list[Step], machine: Machine, told: Progress) -> None:
    with executor(machine.jobs, machine.cluster) as pool:
        for outcome in execute(steps, pool, machine.jobs):
            told.done(outcome.step.name)
            if outcome.error:
                told.say(f"{outcome.step.name}: no result: {outcome.error}")


def _failures(steps: list[Step]) -> dict[str, str]:
    """Return the failed runs of all files, by the name of the first step that failed."""
    failures: dict[str, str] = {}
    seen: set[tuple[str, str, str, int]] = set()
    for step in steps:
        if not step.path.exists():
            failures[step.name] = "its file could not be written"
            continue
        for run, why in failures_of(store.read(step.path, step.runs)).items():
            own = (step.case.scenario_name, step.case.name, step.estimator, run)
            if own in seen or (*own[:2], "", run) in seen:
                continue
            seen.add(own)
            failures[f"{step.name.rsplit(',', 1)[0]}, run {run}"] = why
    return failures


def tabulate(scenario: LoadedScenario, out: Path, runs: int | None) -> pd.DataFrame:
    """Return the cells of all results that are up to date, whatever was asked for last."""
    return cells(scenario, load_results(plan(scenario, out, Selection(runs))))


def chosen(rows: pd.DataFrame, selection: Selection, means: Iterable[str]) -> pd.DataFrame:
    """Return the cells that a selection asks for; means go with a selection of all cases."""
    if selection.estimators:
        rows = rows[rows["estimator"].isin(selection.estimators)]
    if selection.cases:
        rows = rows[rows["case"].isin(selection.cases) & ~rows["case"].isin(list(means))]
    return rows


def write_tables(scenario: LoadedScenario, out: Path, rows: pd.DataFrame) -> None:
    """Write ``tables.csv`` and beside it the tables as in the paper."""
    folder = out / scenario.name
    write_csv(rows, folder / "tables.csv")
    for form in ("md", "tex"):
        (folder / f"tables.{form}").write_text(render(scenario, rows, form), encoding="utf-8")
