"""The tables of a scenario from its results, and the files that they are written to."""

import json
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

import pandas as pd

from debrisest.files import put
from debrisest.results.figured import figured
from debrisest.results.open import find_results
from debrisest.results.status import Wanted, up_to_date
from debrisest.scenario.load import LoadedScenario
from debrisest.show.tables.cells import COLUMNS, framed, rows_of
from debrisest.show.tables.figures import figures_of
from debrisest.show.tables.kept import kept
from debrisest.show.tables.origin import NAME, origin, replaced
from debrisest.show.tables.render import MARK, render


def tabulate(
    scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted]
) -> tuple[pd.DataFrame, list[Wanted]]:
    """Return the cells of all results that are up to date, and the files that are not."""
    simulated, shown = _simulated(scenario), read_by_tables(scenario)
    tables = scenario.common.tables
    files = [one for one in wanted if one.address.stage in shown]
    results = up_to_date(find_results(out / scenario.name), files, complete=True)
    stale = [one for one in files if one.reason]
    rows = kept(
        scenario,
        results,
        lambda: rows_of(scenario, figured(results, partial(figures_of, tables), simulated)),
    )
    return framed(scenario, rows), stale


def read_by_tables(scenario: LoadedScenario) -> set[str]:
    """Return the stages whose files are read."""
    return {"assess", "simulate"} if _simulated(scenario) else {"assess"}


def _simulated(scenario: LoadedScenario) -> set[str]:
    tables = (table for table in scenario.common.tables.layout if table.stage == "simulate")
    return {name for table in tables for name in table.quantities}


def chosen(rows: pd.DataFrame, asked: Callable[[str, str], bool]) -> pd.DataFrame:
    """Return the cells whose case and estimator are asked for."""
    return rows.loc[[asked(*of) for of in zip(rows["case"], rows["estimator"])]]


def write_tables(scenario: LoadedScenario, out: Path, rows: pd.DataFrame) -> list[str]:
    """Write ``tables.csv``, the tables as in the paper, and where they come from.

    What is so already is left. A file of such a name that was not written by this is renamed;
    returns a sentence on each, and on tables of other settings that were there.
    """
    source = out / scenario.name / NAME
    told = origin(scenario, out, rows)
    kept = [sentence] if (sentence := replaced(source, told)) else []
    for form, mark in (("csv", ",".join(COLUMNS)), ("md", MARK), ("tex", MARK)):
        target = out / scenario.name / f"tables.{form}"
        if not _ours(target, mark):
            target.replace(own := target.with_name(f"{target.name}.old"))
            kept.append(f"{target}: this file was not written by debrisest; it is now {own.name}")
        put(target, render(scenario, rows, form).encode())
    put(source, (json.dumps(told, indent=1) + "\n").encode())
    return kept


def _ours(path: Path, mark: str) -> bool:
    """Return whether nothing is lost with a file; pipes and devices, read from, might not end."""
    if path.is_file() or path.is_dir():
        return mark.encode() in path.read_bytes()
    return not path.exists()
