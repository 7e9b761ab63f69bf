"""The commands. Heavy imports stay inside them, so that ``--help`` answers at once."""

import os
import sys
from collections.abc import Callable, Sequence
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from pandas import DataFrame

    from debrisest.run.plan import Selection
    from debrisest.run.sweep import Machine
    from debrisest.scenario.load import LoadedScenario

for _variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")

app = typer.Typer(
    name="debrisest",
    help="Batch experiments on estimating the motion of tumbling space debris from vision.",
    rich_markup_mode=None,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


class Format(StrEnum):
    """How tables are printed."""

    RICH = "rich"
    CSV = "csv"
    MD = "md"
    TEX = "tex"
    JSON = "json"


Configs = Annotated[list[Path], typer.Argument(help="Scenario files (YAML).", metavar="CONFIG...")]
Out = Annotated[Path, typer.Option("--out", help="Folder of results.")]
Jobs = Annotated[int | None, typer.Option("--jobs", min=1, help="Processes (default: all cores).")]
Runs = Annotated[int | None, typer.Option("--runs", min=1, help="Runs per case.")]
CaseNames = Annotated[list[str] | None, typer.Option("--case", help="Only this case (repeatable).")]
EstimatorNames = Annotated[
    list[str] | None, typer.Option("--estimator", help="Only this estimator (repeatable).")
]
Settings = Annotated[
    list[str] | None, typer.Option("--set", help="key.path=value, laid on every case (repeatable).")
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Tell what would run, and why.")]
Force = Annotated[bool, typer.Option("--force", help="Run even what is up to date.")]
Cluster = Annotated[
    str | None, typer.Option("--executor", help="Run on a cluster: dask:tcp://HOST:PORT.")
]
Quiet = Annotated[bool, typer.Option("--quiet", help="No progress.")]
Check = Annotated[bool, typer.Option("--check", help="Exit 1 on unexpected verdicts.")]
Unprinted = Annotated[bool, typer.Option("--quiet", help="Write files, print nothing about them.")]
_RESULTS = Path("results")


def _stage_command(name: str, last_stage: str, help: str) -> None:
    """Register the command that brings one stage, and what it needs before it, up to date."""

    def command(
        configs: Configs,
        out: Out = _RESULTS,
        jobs: Jobs = None,
        runs: Runs = None,
        case: CaseNames = None,
        estimator: EstimatorNames = None,
        settings: Settings = None,
        dry_run: DryRun = False,
        force: Force = False,
        cluster: Cluster = None,
        quiet: Quiet = False,
    ) -> None:
        selection = _selection(runs, case, estimator, force, last_stage)
        machine = _machine(jobs, cluster, quiet)
        _exit(bool(_bring(_loaded(configs, settings), out, selection, machine, dry_run)))

    app.command(name, help=help)(command)


_stage_command("simulate", "simulate", "Simulate truth and measurements.")
_stage_command("recover", "recover", "Recover attitude signals, simulating first where needed.")
_stage_command("filter", "assess", "Run the filters and assess them, doing what they need first.")


@app.command()
def sweep(
    configs: Configs,
    out: Out = _RESULTS,
    jobs: Jobs = None,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    dry_run: DryRun = False,
    force: Force = False,
    cluster: Cluster = None,
    quiet: Quiet = False,
    check: Check = False,
) -> None:
    """Do everything for all cases, then write and print the tables."""
    selection = _selection(runs, case, estimator, force, "assess")
    machine = _machine(jobs, cluster, quiet)
    scenarios = _loaded(configs, settings)
    failures = _bring(scenarios, out, selection, machine, dry_run)
    if not dry_run:
        _exit(_show_tables(scenarios, out, selection, Format.RICH, check) or bool(failures))


@app.command()
def table(
    configs: Configs,
    out: Out = _RESULTS,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    form: Annotated[Format, typer.Option("--format", help="How to print.")] = Format.RICH,
    check: Check = False,
    quiet: Unprinted = False,
) -> None:
    """Write and print the tables of the results that are up to date."""
    from debrisest.run.plan import check_selection

    selection = _selection(runs, case, estimator, False, "assess")
    scenarios = _loaded(configs, settings)
    _told(partial(check_selection, scenarios, selection))
    _exit(_show_tables(scenarios, out, selection, None if quiet else form, check))


@app.command()
def plot(
    configs: Configs,
    out: Out = _RESULTS,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    quiet: Unprinted = False,
) -> None:
    """Draw the figures of the results that are up to date, as PNG and SVG."""

    def draw() -> None:
        from debrisest.run.plan import check_selection, plan
        from debrisest.show.plots.draw import draw_all

        selection = _selection(runs, case, estimator, False, "assess")
        scenarios = _load(configs, settings)
        check_selection(scenarios, selection)
        for scenario in scenarios:
            if not set(scenario.cases) & set(selection.cases or scenario.cases):
                continue
            for path in draw_all(scenario, out, plan(scenario, out, selection)):
                if not quiet:
                    print(path)

    _told(draw)


@app.command()
def status(
    configs: Configs,
    out: Out = _RESULTS,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
) -> None:
    """Tell which results are there, what is out of date and why, and how the runs ended."""
    from debrisest.results.open import find_results
    from debrisest.results.overview import overview
    from debrisest.run.plan import check_selection, plan

    selection = _selection(runs, case, estimator, False, "assess")
    scenarios = _loaded(configs, settings)
    _told(partial(check_selection, scenarios, selection))
    for scenario in scenarios:
        steps = _told(partial(plan, scenario, out, selection))
        results = find_results(out / scenario.name)
        for row in _told(partial(overview, results, steps)):
            print(*row.lines(), sep="\n")
        for sentence in results.left_out:
            print(sentence, file=sys.stderr)


@app.command()
def validate(configs: Configs, settings: Settings = None) -> None:
    """Check scenario files and tell every problem with its line."""
    for scenario in _loaded(configs, settings):
        estimators = ", ".join(scenario.common.estimators)
        print(f"{scenario.path}: {len(scenario.cases)} cases, estimators: {estimators}")


@app.command()
def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    import json

    from debrisest.scenario.schema import ScenarioFile, scenario_model

    print(json.dumps(scenario_model(ScenarioFile).model_json_schema(), indent=1))


def _selection(
    runs: int | None,
    cases: Sequence[str] | None,
    estimators: Sequence[str] | None,
    force: bool,
    last_stage: str,
) -> "Selection":
    from debrisest.run.plan import Selection

    return Selection(runs, cases or None, estimators or None, last_stage, force)


def _machine(jobs: int | None, cluster: str | None, quiet: bool) -> "Machine":
    from debrisest.run.sweep import Machine

    return Machine(jobs or os.cpu_count() or 1, cluster, quiet)


def _bring(
    scenarios: list["LoadedScenario"],
    out: Path,
    selection: "Selection",
    machine: "Machine",
    dry_run: bool,
) -> dict[str, str]:
    from debrisest.run.plan import check_selection, plan
    from debrisest.run.sweep import bring_up_to_date

    _told(partial(check_selection, scenarios, selection))
    if dry_run:
        steps = _told(lambda: [s for scenario in scenarios for s in plan(scenario, out, selection)])
        due = [step for step in steps if step.reason]
        for step in due:
            print(f"{step.name}: {step.reason}")
        print(f"{len(due)} of {len(steps)} steps would run")
        return {}
    failures: dict[str, str] = _told(lambda: bring_up_to_date(scenarios, out, selection, machine))
    for name, why in failures.items():
        print(f"{name} failed: {why}", file=sys.stderr)
    return failures


def _show_tables(
    scenarios: list["LoadedScenario"],
    out: Path,
    selection: "Selection",
    form: Format | None,
    check: bool,
) -> bool:
    """Write all tables, print them in a format; return whether a verdict is not as expected."""
    from debrisest.run.plan import Selection, plan
    from debrisest.show.tables.cells import unexpected
    from debrisest.show.tables.render import render_all
    from debrisest.show.tables.tabulate import chosen, tabulate, write_tables

    every = Selection(selection.runs)
    wrong: list[str] = []
    shown: list[tuple[LoadedScenario, DataFrame]] = []
    for scenario in scenarios:
        steps = _told(partial(plan, scenario, out, every))
        rows, stale = _told(partial(tabulate, scenario, out, steps))
        asked = partial(selection.asks_for, means=scenario.common.tables.means)
        for step in stale[:1]:
            more = f" (and {len(stale) - 1} more)" if len(stale) > 1 else ""
            print(f"left out of the tables: {step.name}: {step.reason}{more}", file=sys.stderr)
        if not rows.empty:
            write_tables(scenario, out, rows)
            shown.append((scenario, chosen(rows, asked)))
        wrong += unexpected(scenario, rows, asked)
    if shown and form is not None:
        print(render_all(shown, form), end="")
    if check:
        for sentence in wrong:
            print(sentence, file=sys.stderr)
        print(f"{len(wrong)} verdicts differ from the expected ones", file=sys.stderr)
    return check and bool(wrong)


def _loaded(configs: list[Path], settings: Sequence[str] | None) -> list["LoadedScenario"]:
    scenarios: list[LoadedScenario] = _told(lambda: _load(configs, settings))
    return scenarios


def _load(configs: list[Path], settings: Sequence[str] | None) -> list["LoadedScenario"]:
    """Load all files, telling the problems of all of them at once."""
    from debrisest.errors import UserError
    from debrisest.scenario.load import load_scenario
    from debrisest.show.tables.published import published_values

    scenarios, problems = [], []
    for path in configs:
        try:
            scenarios.append(load_scenario(path, settings or ()))
            published_values(scenarios[-1])
        except UserError as error:
            problems += error.problems
    stems = [path.stem for path in configs]
    problems += [
        f"{path}: another scenario is called {path.stem} too; results would be mixed"
        for path in configs
        if stems.count(path.stem) > 1
    ]
    if problems:
        raise UserError(problems)
    return scenarios


def _told(action: Callable[[], Any]) -> Any:
    """Run an action; tell the user's mistakes in sentences and exit with 2, 130 on Ctrl-C."""
    from debrisest.errors import UserError

    try:
        return action()
    except UserError as error:
        for problem in error.problems:
            print(problem, file=sys.stderr)
        raise SystemExit(2) from None
    except KeyboardInterrupt:
        print(
            "interrupted: finished steps are kept, the same command goes on from there",
            file=sys.stderr,
        )
        raise SystemExit(130) from None


def _exit(wrong: bool) -> None:
    if wrong:
        raise SystemExit(1)


def main() -> None:
    """Run the command line."""
    app()
