"""Bring scenarios up to date: plan, run what has a reason to run, tell what happened."""

from collections.abc import Container, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from debrisest.errors import UserError
from debrisest.files import remove_leftovers, replacing
from debrisest.results import store
from debrisest.run.execute import execute, executor, failures_of
from debrisest.run.plan import Selection, Step, plan
from debrisest.run.progress import Progress, progress
from debrisest.scenario.load import LoadedScenario
from debrisest.show.tables.cells import cells
from debrisest.show.tables.render import render
from debrisest.show.tables.results import load_results


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
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UserError(f"--out {out}: {error.strerror}; choose another folder") from None
    for scenario in scenarios:
        remove_leftovers(out / scenario.name)
    steps = [step for scenario in scenarios for step in plan(scenario, out, selection)]
    due = [step for step in steps if step.reason]
    with progress(len(due), machine.quiet) as told:
        for step in due:
            if step.notice:
                told.say(step.notice)
        errors = _run(steps, machine, told) if due else {}
    return errors | _failed_runs([step for step in steps if step.name not in errors])


def _run(steps: list[Step], machine: Machine, told: Progress) -> dict[str, str]:
    """Run what is due; return the steps that wrote no file, with reasons."""
    errors: dict[str, str] = {}
    with executor(machine.jobs, machine.cluster) as (pool, width):
        for outcome in execute(steps, pool, width):
            told.done(outcome.step.name)
            if outcome.error:
                errors[outcome.step.name] = outcome.error
    return errors


def _failed_runs(steps: list[Step]) -> dict[str, str]:
    """Return the failed runs of all files, by the name of the first stage that failed."""
    failures: dict[str, str] = {}
    seen: set[tuple[str, str, str, int]] = set()
    for step in steps:
        if not step.path.exists():
            continue
        found = failures_of(store.read(step.path, step.runs, names=("run", "failure")))
        for run, why in found.items():
            own = (step.case.scenario_name, step.case.name, step.estimator, run)
            if own in seen or (*own[:2], "", run) in seen:
                continue
            seen.add(own)
            failures[f"{step.name.rsplit(',', 1)[0]}, run {run}"] = why
    return failures


def tabulate(
    scenario: LoadedScenario, out: Path, runs: int | None
) -> tuple[pd.DataFrame, list[Step]]:
    """Return the cells of all results that are up to date, and the results that are not."""
    simulated = {
        name
        for table in scenario.common.tables.layout
        if table.stage == "simulate"
        for name in table.quantities
    }
    shown = {"assess", "simulate"} if simulated else {"assess"}
    steps = [step for step in plan(scenario, out, Selection(runs)) if step.stage in shown]
    rows = cells(scenario, load_results(steps, simulated))
    return rows, [step for step in steps if step.reason]


def chosen(rows: pd.DataFrame, selection: Selection, means: Container[str]) -> pd.DataFrame:
    """Return the cells that a selection asks for."""
    keep = [
        selection.asks_for(case, estimator, means)
        for case, estimator in zip(rows["case"], rows["estimator"])
    ]
    return rows[keep]


def write_tables(scenario: LoadedScenario, out: Path, rows: pd.DataFrame) -> None:
    """Write ``tables.csv`` and beside it the tables as in the paper."""
    for form in ("csv", "md", "tex"):
        with replacing(out / scenario.name / f"tables.{form}") as path:
            path.write_text(render(scenario, rows, form), encoding="utf-8", newline="\n")
