"""Tables laid out as in the paper: a row per case, the sources side by side."""

from itertools import product
from typing import NamedTuple

import pandas as pd

from debrisest.results.assessed import SIMULATED
from debrisest.scenario.load import LoadedScenario
from debrisest.show.tables.published import CellKey, derived_values
from debrisest.show.tables.verdict import CONSISTENCY, SYMBOLS, Verdict
from debrisest.vocabulary import VOCABULARY

PAPER = "paper"
DERIVED = "*"
"""Stands after a published value that is not printed so."""
_SHOWN = {SIMULATED: "simulated"}
"""Sources that are called otherwise in a laid-out table."""


class Sheet(NamedTuple):
    """One table: its title, the heads of its columns, and rows of text."""

    number: str
    title: str
    heads: list[str]
    rows: list[list[str]]


def sheets(scenario: LoadedScenario, cells: pd.DataFrame) -> list[Sheet]:
    """Return one sheet for each table and window of the scenario that has cells."""
    found = []
    derived = derived_values(scenario, cells)
    marked = [CellKey(*row) in derived for row in cells[list(CellKey._fields)].to_numpy()]
    cells = cells.assign(mark=[DERIVED * is_marked for is_marked in marked])
    for table in scenario.common.tables.layout:
        for statistic, window in product(table.statistics, table.windows):
            chosen = cells[
                (cells["table"] == table.table)
                & (cells["window"] == window)
                & (cells["statistic"] == statistic)
                & cells["quantity"].isin(table.quantities)
            ]
            if not chosen.empty:
                heads, rows = _grid(chosen)
                alone = f"{_heads(chosen)[0]}, " if len(table.quantities) == 1 else ""
                title = f"{table.title}: {alone}{statistic}, {window}"
                found.append(Sheet(table.table, title, heads, rows))
    return found


def _grid(cells: pd.DataFrame) -> tuple[list[str], list[list[str]]]:
    """Sources side by side for a single quantity, one below the other for several or for words."""
    names = list(dict.fromkeys(cells["quantity"]))
    by_case = list(cells.groupby("case", sort=False))
    if len(names) == 1 and not cells["verdict"].isin(CONSISTENCY).any():
        sources = _sources(cells)
        rows = [
            [str(case), *(_text(part, source, names[0]) for source in sources)]
            for case, part in by_case
        ]
        return ["case", *(_SHOWN.get(source, source) for source in sources)], rows
    rows = [
        [str(case), _SHOWN.get(source, source), *(_text(part, source, name) for name in names)]
        for case, part in by_case
        for source in _sources(part)
    ]
    return ["case", "source", *_heads(cells)], rows


def _heads(cells: pd.DataFrame) -> list[str]:
    """Return the quantities with their units."""
    pairs = dict.fromkeys(zip(cells["quantity"], cells["unit"]))
    return [f"{name} ({unit})" if unit != "1" else str(name) for name, unit in pairs]


def _sources(cells: pd.DataFrame) -> list[str]:
    paper = [PAPER] if cells["published"].notna().any() else []
    return [*paper, *dict.fromkeys(cells["estimator"])]


def _text(part: pd.DataFrame, source: str, quantity: str) -> str:
    """Return a figure of three digits, its verdict's sign, and before it the runs left out."""
    part = part[part["quantity"] == quantity]
    if source == PAPER:
        published = part[part["published"].notna()]
        return "".join(f"{row.published:.3g}{row.mark}" for row in published[:1].itertuples())
    own = part[part["estimator"] == source]
    if own.empty:
        return ""
    measured, verdict = own["measured"].iloc[0], own["verdict"].iloc[0]
    figure = f"{measured:.3g}{VOCABULARY[quantity].after_figure}" if pd.notna(measured) else "-"
    lost = int(own["failed"].iloc[0] + own["diverged"].iloc[0])
    note = f"({lost}) " if lost else ""
    return f"{note}{figure} {SYMBOLS[Verdict(verdict)]}".rstrip()
