"""The command that shows and exports what filters estimated."""

import sys
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Option

from debrisest.cli.inputs import load_all, select
from debrisest.cli.options import (
    RESULTS,
    CaseNames,
    Configs,
    EstimatorNames,
    Out,
    Plugins,
    Settings,
    Variant,
)

if TYPE_CHECKING:
    from debrisest.results.results import Results
    from debrisest.runner.selection import Selection
    from debrisest.scenario.load import LoadedScenario


class EstimateFormat(StrEnum):
    """How estimates are printed."""

    RICH = "rich"
    CSV = "csv"
    JSON = "json"


Run = Annotated[int, Option("--run", min=0, help="Show this run.")]
At = Annotated[float | None, Option("--at", help="Show the epoch at this time, s (default: end).")]
Form = Annotated[EstimateFormat, Option("--format", help="How to print.")]


def estimates(
    configs: Configs,
    out: Out = RESULTS,
    run: Run = 0,
    at: At = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    variant: Variant = None,
    plugins: Plugins = None,
    form: Form = EstimateFormat.RICH,
) -> None:
    """Print estimates with their sigma; write those of all epochs and runs to estimates.csv.

    Both hold the cases and estimators that are asked for.
    """
    from debrisest.errors import UserError
    from debrisest.show.estimate_tables import render_estimates
    from debrisest.show.estimates import estimates_at, export

    scenarios = load_all(configs, settings, plugins, variant)
    selection = select(scenarios, None, case, estimator, "filter")
    current = [(one.name, current_estimates(one, out, selection)) for one in scenarios]
    time = float("inf") if at is None else at
    found = [(name, one) for name, there in current for one in estimates_at(there, run, time)]
    if not found:
        names = " ".join(map(str, configs))
        raise UserError(
            f"no estimates of run {run} that are up to date; run: debrisest sweep {names}"
        )
    print(render_estimates(found, form), end="")
    for name, there in current:
        if not there.chunks:
            continue
        path = out / name / "estimates.csv"
        print(f"wrote {path}: {export(there, path)} rows", file=sys.stderr)


def estimates_of(scenarios: Sequence["LoadedScenario"], out: Path, selection: "Selection") -> str:
    """Return the estimates of the first run at the last epoch, as text for the terminal."""
    from debrisest.show.estimate_tables import render_estimates
    from debrisest.show.estimates import estimates_at

    found = [
        (scenario.name, one)
        for scenario in scenarios
        for one in estimates_at(current_estimates(scenario, out, selection))
    ]
    return render_estimates(found, EstimateFormat.RICH)


def current_estimates(scenario: "LoadedScenario", out: Path, selection: "Selection") -> "Results":
    """Return the filters' results that are up to date, of as many runs as there are.

    What is out of date is told.
    """
    from debrisest.results.address import STAGES
    from debrisest.results.open import find_results
    from debrisest.results.status import up_to_date
    from debrisest.runner.plan import plan
    from debrisest.runner.selection import Selection
    from debrisest.runner.step import Step

    there = find_results(out / scenario.name)
    files: dict[Path, Step] = {}
    for case, estimator in _asked(scenario, selection):
        runs = there.runs(case, estimator, "filter") or selection.runs
        selected = Selection(runs, [case], [estimator], "filter")
        for step in plan(scenario, out, selected, STAGES):
            if step.path not in files or step.runs > files[step.path].runs:
                files[step.path] = step
    stale = [one for one in files.values() if one.reason]
    for step in stale[:1]:
        more = f" (and {len(stale) - 1} more)" if len(stale) > 1 else ""
        print(f"left out of the estimates: {step.name}: {step.reason}{more}", file=sys.stderr)
    return up_to_date(there, files.values())


def _asked(scenario: "LoadedScenario", selection: "Selection") -> Sequence[tuple[str, str]]:
    """Return the cases and estimators of a scenario that are asked for and have a filter."""
    return [
        (name, estimator)
        for name, case in scenario.cases.items()
        for estimator in case.estimators
        if selection.asks_for(name, estimator, ())
        and case.scenario.estimators[estimator].filter is not None
    ]
