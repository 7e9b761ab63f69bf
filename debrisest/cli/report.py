"""The command that writes all that was found into one file for a browser."""

import os
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Option

from debrisest.cli.inputs import load_all, named, select
from debrisest.cli.options import (
    RESULTS,
    CaseNames,
    Configs,
    EstimatorNames,
    Jobs,
    Out,
    Plugins,
    Runs,
    Settings,
    Unprinted,
    Variant,
)

if TYPE_CHECKING:
    from debrisest.runner.selection import Selection
    from debrisest.scenario.load import LoadedScenario
    from debrisest.show.report.chapter import Chapter


def report(
    configs: Configs,
    out: Out = RESULTS,
    jobs: Jobs = None,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    variant: Variant = None,
    plugins: Plugins = None,
    figures: Annotated[bool, Option("--figures/--no-figures", help="With or without.")] = True,
    figures_of: Annotated[
        list[str] | None,
        Option("--figures-of", metavar="CASE", help="Of this case, not the first (repeatable)."),
    ] = None,
    to: Annotated[Path | None, Option("--to", help="File (default: report.html in DIR).")] = None,
    quiet: Unprinted = False,
) -> None:
    """Write the results that are up to date into one file of HTML that needs no network."""
    scenarios = load_all(configs, settings, plugins, variant)
    selection = select(scenarios, runs, case, estimator)
    _check_cases(scenarios, figures_of or ())
    shown = (figures_of or ()) if figures else None
    path = write_report(scenarios, out, selection, settings or (), shown, to, jobs)
    if not quiet:
        print(f"wrote {path}")


def _check_cases(scenarios: Sequence["LoadedScenario"], names: Sequence[str]) -> None:
    """Raise UserError for cases that no scenario has."""
    from debrisest.errors import UserError, allowed_names

    known = dict.fromkeys(name for scenario in scenarios for name in scenario.cases)
    problems = [
        f"--figures-of {name}: unknown case; {allowed_names(name, known)}"
        for name in names
        if name not in known
    ]
    if problems:
        raise UserError(problems)


def write_report(
    scenarios: Sequence["LoadedScenario"],
    out: Path,
    selection: "Selection",
    settings: Sequence[str] = (),
    figures_of: Sequence[str] | None = (),
    to: Path | None = None,
    jobs: int | None = None,
) -> Path:
    """Write the report; return its path. Tells which scenarios have no results.

    With the figures of some cases, or with one of each kind if none are named, or without (None).
    Worker processes make the chapters, which are many figures each.
    """
    from debrisest.errors import UserError
    from debrisest.files import replacing
    from debrisest.runner.executors import executor
    from debrisest.show.report.page import environment, page

    environment()
    with executor(min(jobs or os.cpu_count() or 1, len(scenarios))) as (pool, _):
        asked = (out, selection, settings, figures_of)
        each = [pool.submit(_chapter, scenario, *asked) for scenario in scenarios]
        told = [chapter.result() for chapter in each]
    for scenario, chapter in zip(scenarios, told):
        if not chapter:
            print(f"left out of the report: {scenario.name}: no results", file=sys.stderr)
    chapters = [chapter for chapter in told if chapter]
    if not chapters:
        names = shlex.join(named(scenarios, out, settings))
        raise UserError(f"no results that are up to date; run: debrisest sweep {names}")
    alone = [chapter.name for chapter in chapters if len(scenarios) == 1]
    path = to or Path(out, *alone, "report.html")
    with replacing(path) as temporary:
        temporary.write_text(page(chapters), encoding="utf-8")
    return path


def _chapter(
    scenario: "LoadedScenario",
    out: Path,
    selection: "Selection",
    settings: Sequence[str],
    figures_of: Sequence[str] | None,
) -> "Chapter | None":
    from dataclasses import replace
    from functools import partial

    from debrisest.results.address import STAGES
    from debrisest.results.open import find_results
    from debrisest.results.status import up_to_date
    from debrisest.runner.plan import plan
    from debrisest.runner.selection import Selection
    from debrisest.show.report.chapter import chapter
    from debrisest.show.report.figures import pictures
    from debrisest.show.tables.tabulate import chosen, read_by_tables, tabulate

    steps = plan(scenario, out, selection, STAGES)
    results = up_to_date(find_results(out / scenario.name), steps)
    if not results.chunks:
        return None
    wanted = plan(scenario, out, Selection(selection.runs), read_by_tables(scenario))
    rows, _ = tabulate(scenario, out, wanted)
    asked = partial(selection.asks_for, means=scenario.common.tables.means)
    others = [case for case in figures_of or () if case in scenario.cases]
    shown = plan(scenario, out, replace(selection, cases=others), STAGES) if others else steps
    drawn = () if figures_of is None else pictures(scenario, out, shown, bool(others))
    command = shlex.join(named([scenario], out, settings))
    return chapter(scenario, command, results, steps, chosen(rows, asked), settings, drawn)
