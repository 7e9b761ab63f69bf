"""What the report tells of one scenario: words, tables, overviews, figures, provenance."""

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from debrisest.results.overview import overview
from debrisest.results.results import Results
from debrisest.results.runs import SIMULATED
from debrisest.results.status import Wanted
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.resolved import resolved
from debrisest.show.report.figures import Picture
from debrisest.show.report.overview import Panel, panels
from debrisest.show.tables.render import legends

_MOST_SENTENCES = 12


class Section(NamedTuple):
    """A table: its number and title, its overviews, and its cells, a column each by name."""

    number: str
    title: str
    panels: list[Panel]
    estimators: list[str]
    cells: list[dict[Hashable, Any]]


class Chapter(NamedTuple):
    """What the report tells of one scenario."""

    name: str
    command: str
    title: str
    source: str
    counts: dict[str, int]
    """How many cells have which verdict."""
    words: list[str]
    ended: list[str]
    """How runs failed or ended, in the sentences of the stages."""
    legends: list[str]
    sections: list[Section]
    figures: list[Picture]
    provenance: dict[str, str]
    scenario: str
    """The resolved scenario of the first case, as YAML."""


def chapter(
    scenario: LoadedScenario,
    command: str,
    results: Results,
    wanted: Sequence[Wanted],
    cells: pd.DataFrame,
    settings: Sequence[str],
    figures: Iterable[Picture],
) -> Chapter:
    """Return a chapter of the cells of a scenario and of the files that a plan wants.

    ``command`` are the arguments that name its results on the command line.
    """
    common = scenario.common
    return Chapter(
        name=scenario.name,
        command=command,
        title=common.title,
        source=common.source,
        counts=dict(Counter(cells["verdict"])),
        words=_words(scenario, cells, wanted),
        ended=_ended(results, wanted),
        legends=legends(scenario, cells),
        sections=list(_sections(scenario, cells)),
        figures=list(figures),
        provenance=_provenance(scenario, results, settings),
        scenario=resolved(next(iter(scenario.cases.values()))),
    )


def _words(scenario: LoadedScenario, cells: pd.DataFrame, wanted: Sequence[Wanted]) -> list[str]:
    """Return in words what was run and how it came out."""
    own = cells[~cells["case"].isin(scenario.common.tables.means)]
    runs = own.groupby(["case", "estimator"])["runs"].max()
    most = f"up to {runs.max()} runs each" if len(runs) else "no runs"
    told = [
        f"{own['case'].nunique()} cases by {own['estimator'].nunique()} estimators, {most}, "
        f"in {len(cells)} cells."
    ]
    known = cells[cells["published"].notna()]
    if len(known):
        counted = ", ".join(f"{n} {said}" for said, n in known["verdict"].value_counts().items())
        told.append(f"Of {len(known)} cells with a published value: {counted}.")
    bounded = cells[(cells["bound"] > 0) & cells["published"].notna() & (cells["measured"] > 0)]
    for name, part in bounded.groupby("estimator", sort=False):
        ratio = (part["measured"] / part["bound"]).median()
        told.append(f"{name}: {ratio:.3g} times the bound in the median of {len(part)} such cells.")
    stale = [one for one in wanted if one.reason]
    if stale:
        told.append(f"{len(stale)} files are out of date and left out: {stale[0].reason}.")
    return told


def _ended(results: Results, wanted: Sequence[Wanted]) -> list[str]:
    """Return how many runs failed or ended in which way, the most frequent first."""
    failed: Counter[str] = Counter()
    ended: Counter[str] = Counter()
    for row in overview(results, wanted):
        failed.update({f"{row.estimator}: {why}": n for why, n in row.failed.items()})
        ended.update({f"{row.estimator}: {how}": n for how, n in row.ended.items()})
    both = [*failed.most_common(), *ended.most_common()]
    told = [f"{how} ({runs} runs)" for how, runs in both[:_MOST_SENTENCES]]
    more = len(both) - len(told)
    return [*told, *[f"and {more} more; debrisest status tells all"] * (more > 0)]


def _sections(scenario: LoadedScenario, cells: pd.DataFrame) -> Iterator[Section]:
    for number, part in cells.groupby("table", sort=False):
        titles = [t.title for t in scenario.common.tables.layout if t.table == number]
        lost = part["failed"] + part["diverged"]
        rows = part.assign(ratio=part["measured"] / part["bound"].where(part["bound"] > 0))
        rows = rows.assign(left_out=lost).astype(object).where(rows.notna(), None)
        names = [name for name in dict.fromkeys(part["estimator"]) if name != SIMULATED]
        found = list(panels(part, names))
        yield Section(str(number), titles[0], found, names, rows.to_dict("records"))


def _provenance(
    scenario: LoadedScenario, results: Results, settings: Sequence[str]
) -> dict[str, str]:
    told = [chunk.attributes for chunk in results.chunks]
    created = sorted(str(each["created"]) for each in told)
    measured = scenario.common.measured is not None
    return {
        "scenario": Path(scenario.path).name,
        "changed by --set": ", ".join(settings) or "nothing",
        "seed": "measured data" if measured else str(scenario.common.seed),
        "software": _each(str(each.get("software")) for each in told),
        "commit": _each(str(each.get("commit")) for each in told),
        "computed": f"{created[0]} to {created[-1]}" if created else "never",
    }


def _each(values: Iterator[str]) -> str:
    return "; ".join(dict.fromkeys(values))
