"""The commands that show results: table, plot, status."""

import shlex
import sys
from collections.abc import Sequence
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Option

from debrisest.cli.estimates import estimates_of
from debrisest.cli.exits import exit_if
from debrisest.cli.inputs import load_all, named, select
from debrisest.cli.options import (
    RESULTS,
    CaseNames,
    Check,
    Configs,
    EstimatorNames,
    Form,
    Format,
    Out,
    Plugins,
    Runs,
    Settings,
    Unprinted,
    Variant,
)


class FigureFormat(StrEnum):
    """How figures are written."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


Figures = Annotated[list[str] | None, Option("--figure", help="Only this figure (repeatable).")]
OneRun = Annotated[
    int | None, Option("--run", min=0, help="This run, in figures of one (default: the first).")
]
FigureFormats = Annotated[
    list[FigureFormat] | None, Option("--format", help="Format (repeatable; default: png, svg).")
]

if TYPE_CHECKING:
    from pandas import DataFrame

    from debrisest.runner.selection import Selection
    from debrisest.scenario.load import LoadedScenario


def table(
    configs: Configs,
    out: Out = RESULTS,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    variant: Variant = None,
    plugins: Plugins = None,
    form: Form = Format.RICH,
    check: Check = False,
    quiet: Unprinted = False,
) -> None:
    """Write and print the tables of the results that are up to date."""
    scenarios = load_all(configs, settings, plugins, variant)
    selection = select(scenarios, runs, case, estimator)
    wrong = show_tables(scenarios, out, selection, None if quiet else form, check)
    for scenario in scenarios:
        if scenario.variant and (out / scenario.name / "tables.csv").is_file():
            print(f"these tables are of {out / scenario.name}", file=sys.stderr)
        elif scenario.variant:
            words = shlex.join(named([scenario], out, settings or ()))
            told = f"{out / scenario.name}: there is no such variant"
            print(f"{told}; run: debrisest sweep {words}", file=sys.stderr)
        elif names := _variants(scenario, out):
            told = f"{scenario.path}: there are variants too: {' '.join(names)}; show one with"
            print(f"{told} the --set and --variant that it was made with", file=sys.stderr)
    exit_if(wrong)


def _variants(scenario: "LoadedScenario", out: Path) -> list[str]:
    """Return the names of the variants of a scenario that have tables."""
    from debrisest.scenario.names import VARIANT

    if not out.is_dir():
        return []
    start = f"{scenario.name}{VARIANT}"
    folders = (path for path in out.iterdir() if (path / "tables.csv").is_file())
    return sorted(path.name.removeprefix(start) for path in folders if path.name.startswith(start))


def plot(
    configs: Configs,
    out: Out = RESULTS,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    variant: Variant = None,
    plugins: Plugins = None,
    figure: Figures = None,
    run: OneRun = None,
    form: FigureFormats = None,
    quiet: Unprinted = False,
) -> None:
    """Draw the figures of the results that are up to date, by default as PNG and SVG."""
    from debrisest.results.address import STAGES
    from debrisest.runner.plan import plan
    from debrisest.show.plots.draw import Asked, check_asked, draw_all, without_trajectories
    from debrisest.show.plots.files import USUAL

    wanted = Asked(figure or (), run, form or USUAL)
    check_asked(wanted)
    scenarios = load_all(configs, settings, plugins, variant)
    selection = select(scenarios, runs, case, estimator)
    asked = [one for one in scenarios if set(one.cases) & set(selection.cases or one.cases)]
    drawn: list[Path] = []
    for one in asked:
        steps = plan(one, out, selection, STAGES)
        drawn += draw_all(one, out, steps, wanted)
        if lacking := without_trajectories(one, out, steps, wanted):
            more = f" (and {len(lacking) - 1} more)" if len(lacking) > 1 else ""
            print(f"not all is drawn: {lacking[0]}{more}", file=sys.stderr)
    if not quiet:
        print(*drawn, sep="\n")


def status(
    configs: Configs,
    out: Out = RESULTS,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    variant: Variant = None,
    plugins: Plugins = None,
) -> None:
    """Tell which results are there, what is out of date and why, and how the runs ended."""
    from debrisest.results.open import find_results
    from debrisest.results.overview import overview
    from debrisest.runner.plan import plan

    scenarios = load_all(configs, settings, plugins, variant)
    selection = select(scenarios, runs, case, estimator)
    for scenario in scenarios:
        results = find_results(out / scenario.name)
        for row in overview(results, plan(scenario, out, selection)):
            print(*row.lines(), sep="\n")
        for sentence in results.left_out:
            print(sentence, file=sys.stderr)


def show_tables(
    scenarios: Sequence["LoadedScenario"],
    out: Path,
    selection: "Selection",
    form: Format | None,
    check: bool,
) -> bool:
    """Write all tables, print them in a format; return whether a verdict is not as expected.

    They are printed too where they cannot be written, which then raises OSError.
    """
    from debrisest.runner.plan import plan
    from debrisest.runner.selection import Selection
    from debrisest.show.tables.cells import unexpected
    from debrisest.show.tables.render import render_all
    from debrisest.show.tables.tabulate import chosen, read_by_tables, tabulate, write_tables

    wrong: list[str] = []
    unwritten: list[OSError] = []
    shown: list[tuple[LoadedScenario, DataFrame]] = []
    for scenario in scenarios:
        wanted = plan(scenario, out, Selection(selection.runs), read_by_tables(scenario))
        rows, stale = tabulate(scenario, out, wanted)
        asked = partial(selection.asks_for, means=scenario.common.tables.means)
        for step in stale[:1]:
            more = f" (and {len(stale) - 1} more)" if len(stale) > 1 else ""
            print(f"left out of the tables: {step.name}: {step.reason}{more}", file=sys.stderr)
        if not rows.empty:
            try:
                for sentence in write_tables(scenario, out, rows):
                    print(sentence, file=sys.stderr)
            except OSError as error:
                unwritten.append(error)
            shown.append((scenario, chosen(rows, asked)))
        wrong += unexpected(scenario, rows, asked)
    if shown and form is not None:
        print(render_all(shown, form), end="")
    if form is Format.RICH:
        measured = [one for one in scenarios if one.common.measured is not None]
        print(estimates_of(measured, out, selection), end="")
    if check:
        for sentence in wrong:
            print(sentence, file=sys.stderr)
        print(f"{len(wrong)} verdicts differ from the expected ones", file=sys.stderr)
    for failure in unwritten:
        raise failure
    return check and bool(wrong)
