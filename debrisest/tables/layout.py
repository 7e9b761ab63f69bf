"""Tables laid out as in the paper: a row per case, the sources side by side."""

from typing import NamedTuple

import pandas as pd

from debrisest.scenario.load import LoadedScenario
from debrisest.tables.verdict import SYMBOLS, Verdict

PAPER = "paper"


class Sheet(NamedTuple):
    """One table: its title, the heads of its columns, and rows of text."""

    number: str
    title: str
    heads: list[str]
    rows: list[list[str]]


def sheets(scenario: LoadedScenario, cells: pd.DataFrame) -> list[Sheet]:
    """Return one sheet for each table and window of the scenario that has cells."""
    found = []
    for table in scenario.any.tables.layout:
        for window in table.windows:
            chosen = cells[
                (cells["table"] == table.table)
                & (cells["window"] == window)
                & (cells["statistic"] == table.statistic)
                & cells["quantity"].isin(table.quantities)
            ]
            if not chosen.empty:
                title = f"{table.title} ({table.statistic}, {window})"
                found.append(Sheet(table.table, title, *_grid(chosen)))
    return found


def _grid(cells: pd.DataFrame) -> tuple[list[str], list[list[str]]]:
    """Sources side by side for a single quantity, one below the other for several."""
    names = list(dict.fromkeys(zip(cells["quantity"], cells["unit"])))
    heads = [f"{name} [{unit}]" if unit != "1" else name for name, unit in names]
    sources = _sources(cells)
    if len(names) == 1:
        rows = [
            [str(case), *(_text(part, source, names[0][0]) for source in sources)]
            for case, part in cells.groupby("case", sort=False)
        ]
        return ["case", *(f"{source} {heads[0]}" for source in sources)], rows
    rows = [
        [str(case), source, *(_text(part, source, name) for name, _ in names)]
        for case, part in cells.groupby("case", sort=False)
        for source in sources
    ]
    return ["case", "source", *heads], rows


def _sources(cells: pd.DataFrame) -> list[str]:
    paper = [PAPER] if cells["published"].notna().any() else []
    return [*paper, *dict.fromkeys(cells["estimator"])]


def _text(part: pd.DataFrame, source: str, quantity: str) -> str:
    """Return a figure of three digits and the symbol of its verdict."""
    part = part[part["quantity"] == quantity]
    if source == PAPER:
        published = part["published"].dropna()
        return f"{published.iloc[0]:.3g}" if len(published) else ""
    own = part[part["estimator"] == source]
    if own.empty:
        return ""
    measured, verdict = own["measured"].iloc[0], own["verdict"].iloc[0]
    figure = f"{measured:.3g}" if pd.notna(measured) else "-"
    return f"{figure} {SYMBOLS[Verdict(verdict)]}".rstrip()
