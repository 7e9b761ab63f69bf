"""The command that writes all that was found into one file for a browser."""

import sys
from collections.abc import Sequence
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
    Runs,
    Settings,
    Unprinted,
    Variant,
)

if TYPE_CHECKING:
    from debrisest.runner.plan import Selection
    from debrisest.scenario.load import LoadedScenario
    from debrisest.show.report.chapter import Chapter


def report(
    configs: Configs,
    out: Out = RESULTS,
    runs: Runs = None,
    case: CaseNames = None,
    estimator: EstimatorNames = None,
    settings: Settings = None,
    variant: Variant = None,
    plugins: Plugins = None,
    figures: Annotated[
        bool, Option("--figures/--no-figures", help="With those of the first case.")
    ] = True,
    to: Annotated[Path | None, Option("--to", help="File (default: report.html in DIR).")] = None,
    quiet: Unprinted = False,
) -> None:
    """Write the results that are up to date into one file of HTML that needs no network."""
    scenarios = load_all(configs, settings, plugins, variant)
    selection = select(scenarios, runs, case, estimator)
    path = write_report(scenarios, out, selection, settings or (), figures, to)
    if not quiet:
        print(f"wrote {path}")


def write_report(
    scenarios: Sequence["LoadedScenario"],
    out: Path,
    selection: "Selection",
    settings: Sequence[str] = (),
    figures: bool = True,
    to: Path | None = None,
) -> Path:
    """Write the report; return its path. Tells which scenarios have no results."""
    from debrisest.errors import UserError
    from debrisest.files import replacing
    from debrisest.show.report.page import page

    chapters = []
    for scenario in scenarios:
        if told := _chapter(scenario, out, selection, settings, figures):
            chapters.append(told)
        else:
            print(f"left out of the report: {scenario.name}: no results", file=sys.stderr)
    if not chapters:
        names = " ".join(str(scenario.path) for scenario in scenarios)
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
    figures: bool,
) -> "Chapter | None":
    from functools import partial

    from debrisest.results.address import STAGES
    from debrisest.results.open import find_results
    from debrisest.results.status import up_to_date
    from debrisest.runner.plan import Selection, plan
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
    drawn = pictures(scenario, out, steps) if figures else iter(())
    return chapter(scenario, results, steps, chosen(rows, asked), settings, drawn)
