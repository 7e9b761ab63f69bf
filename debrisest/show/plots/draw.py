"""The figures that a scenario's results allow, and their files."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure

from debrisest.errors import UserError, allowed_names
from debrisest.results.assessed import Assessed, assessed
from debrisest.results.open import find_results
from debrisest.results.status import Wanted, up_to_date
from debrisest.scenario.curves import curves
from debrisest.scenario.load import LoadedScenario
from debrisest.show.plots.along import along_curves
from debrisest.show.plots.beside import beside
from debrisest.show.plots.files import USUAL, write
from debrisest.show.plots.gather import (
    Source,
    Wants,
    all_runs,
    chosen_run,
    of_estimators,
    simulations,
    single_runs,
)
from debrisest.show.plots.kinds import FIGURES, Kind
from debrisest.show.plots.style import collected_after, style
from debrisest.show.plots.tumble import tumbles, write_tumble
from debrisest.show.tables.tabulate import tabulate


class Asked(NamedTuple):
    """Which figures are wanted, of which run, in which formats."""

    figures: Sequence[str] = ()
    """By name; empty for all."""
    run: int | None = None
    """Of figures of one run; by default the first that did not fail."""
    formats: Sequence[str] = USUAL
    wants: Callable[[str, tuple[str, ...]], bool] = lambda kind, names: True
    """Whether a figure of a kind, of these case and estimator, is; asked before data are read."""


ALL = Asked()
FILM = "tumble"
"""An animation, which takes a while: it is drawn only where it is asked for."""


def draw_all(
    scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted], asked: Asked = ALL
) -> Iterator[Path]:
    """Draw what the results that are up to date allow; yield each file once it is written."""
    folder = out / scenario.name / "plots"
    drawn = False
    for name, source in sources(scenario, out, wanted, asked):
        called = "-".join((name, *source.names))
        drawn = True
        with style(), collected_after():
            shaded = FIGURES[name].shaded
            paths = list(write(draw(name, source), folder, called, asked.formats, shaded))
        yield from paths
    if FILM in asked.figures:
        for source in tumbles(scenario, up_to_date(find_results(out / scenario.name), wanted)):
            drawn = True
            yield write_tumble(source, folder)
    if not drawn:
        raise UserError(
            without_trajectories(scenario, out, wanted, asked)
            or f"{scenario.name}: no results that are up to date to draw; "
            f"run: debrisest sweep {scenario.path}"
        )


def draw(name: str, source: Source) -> Figure:
    """Return a figure by its name."""
    kind = FIGURES[name]
    if kind.beside is not None:
        return kind.beside(source.data, source.context, source.beside)
    return kind.draw(source.data, source.context)


def without_trajectories(
    scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted], asked: Asked = ALL
) -> list[str]:
    """Return a sentence for each case and estimator of which figures of one run lack their data."""
    if not any(FIGURES[name].of_one_run for name in asked.figures or FIGURES if name != FILM):
        return []
    results = up_to_date(find_results(out / scenario.name), wanted)
    told = []
    for case in results.cases:
        for estimator in results.estimators(case):
            run = chosen_run(results, case, estimator, asked.run)
            if run is not None and not results.is_whole(case, estimator, run):
                told.append(results.not_kept(case, estimator, run))
    return told


def check_asked(asked: Asked) -> None:
    """Raise UserError for figures that do not exist."""
    problems = [
        f"--figure {name}: no such figure; {allowed_names(name, [*FIGURES, FILM])}"
        for name in asked.figures
        if name not in (*FIGURES, FILM)
    ]
    if problems:
        raise UserError(problems)


def sources(
    scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted], asked: Asked = ALL
) -> Iterator[tuple[str, Source]]:
    """Return every figure that can be drawn, with its data."""
    there = find_results(out / scenario.name)
    results = up_to_date(there, wanted)
    errors = assessed(up_to_date(there, wanted, complete=True))
    chosen = {n: k for n, k in FIGURES.items() if not asked.figures or n in asked.figures}
    of_one_run = {name: kind for name, kind in chosen.items() if kind.of_one_run}
    of_simulation = {name: kind for name, kind in chosen.items() if kind.of_simulation}
    if of_one_run:
        wants = partial(_wanted, of_one_run, asked)
        for source in single_runs(scenario, results, errors, asked.run, wants):
            yield from ((name, source) for name in wants(source.names, set(source.data)))
    if of_simulation:
        wants = partial(_wanted, of_simulation, asked)
        for source in simulations(scenario, results, asked.run, wants):
            yield from ((name, source) for name in wants(source.names, set(source.data)))
    for name, kind in chosen.items():
        own = partial(_wanted, {name: kind}, asked)
        if kind.of_all_runs:
            yield from ((name, source) for source in _of_all_runs(scenario, errors, kind, own))
        if kind.of_tables and curves(scenario.cases):
            cells, _ = tabulate(scenario, out, wanted)
            yield from ((name, source) for source in along_curves(scenario, cells))
        if kind.of_estimators:
            found = of_estimators(scenario, errors, kind.needs, own)
            yield from ((name, source) for source in found)


def _wanted(
    figures: dict[str, Kind], asked: Asked, names: tuple[str, ...], datasets: set[str]
) -> list[str]:
    """Return the figures that are wanted of these names, and whose datasets are all there."""
    able = [name for name, kind in figures.items() if set(kind.needs) <= datasets]
    return [name for name in able if asked.wants(name, names)]


def _of_all_runs(
    scenario: LoadedScenario, results: Assessed, kind: Kind, wants: Wants
) -> Iterator[Source]:
    """Return all runs of an estimator: of each case by itself, or of those that have a mean."""
    if scenario.common.tables.means and not kind.of_each_case:
        yield from all_runs(scenario, results, kind.needs, wants)
        return
    for (case, estimator), result in results.items():
        quantities = [*kind.needs, *(name for name in kind.also if name in result.errors)]
        if not wants((case, estimator), set(quantities)):
            continue
        for source in all_runs(scenario, {(case, estimator): result}, quantities):
            context = source.context.replace("1 case,", f"case {case},", 1)
            found = source._replace(names=(case, estimator), context=context)
            if kind.beside is not None:
                found = found._replace(
                    beside=beside(scenario, results, case, estimator, quantities)
                )
            yield found
