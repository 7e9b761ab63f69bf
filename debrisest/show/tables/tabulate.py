"""The tables of a scenario from its results, and the files that they are written to."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pandas as pd

from debrisest.files import put
from debrisest.results.assessed import assessed
from debrisest.results.open import find_results
from debrisest.results.status import Wanted, up_to_date
from debrisest.scenario.load import LoadedScenario
from debrisest.show.tables.cells import cells
from debrisest.show.tables.render import render


def tabulate(
    scenario: LoadedScenario, out: Path, wanted: Sequence[Wanted]
) -> tuple[pd.DataFrame, list[Wanted]]:
    """Return the cells of all results that are up to date, and the files that are not."""
    simulated = {
        name
        for table in scenario.common.tables.layout
        if table.stage == "simulate"
        for name in table.quantities
    }
    shown = {"assess", "simulate"} if simulated else {"assess"}
    files = [one for one in wanted if one.address.stage in shown]
    results = up_to_date(find_results(out / scenario.name), files, complete=True)
    stale = [one for one in files if one.reason]
    return cells(scenario, assessed(results, simulated)), stale


def chosen(rows: pd.DataFrame, asked: Callable[[str, str], bool]) -> pd.DataFrame:
    """Return the cells whose case and estimator are asked for."""
    return rows[[asked(*of) for of in zip(rows["case"], rows["estimator"])]]


def write_tables(scenario: LoadedScenario, out: Path, rows: pd.DataFrame) -> None:
    """Write ``tables.csv`` and beside it the tables as in the paper, where they are not so yet."""
    for form in ("csv", "md", "tex"):
        put(out / scenario.name / f"tables.{form}", render(scenario, rows, form).encode())
