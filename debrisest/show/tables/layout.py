"""Tables laid out as in the paper: a row per case, the sources side by side."""

from itertools import product
from typing import Any, NamedTuple

import pandas as pd

from debrisest.results.assessed import SIMULATED
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.schema import Table
from debrisest.show.tables.published import CellKey, derived_values
from debrisest.show.tables.verdict import CONSISTENCY, SYMBOLS, Verdict
from debrisest.vocabulary import VOCABULARY

PAPER = "paper"
BELOW = "?"
"""Stands after a ratio to a bound that the figure is below by more than chance."""
SHARES = ("share", "ever")
SQUARES = tuple(name for name, entry in VOCABULARY.items() if entry.chi_square)
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


class _Cell(NamedTuple):
    """What is shown of a row of the cells, as a record, which is read faster than a frame."""

    quantity: str
    estimator: str
    published: float
    measured: float
    ci_low: float
    ci_high: float
    bound: float
    failed: int
    diverged: int
    verdict: str
    mark: str
    has_ratio: bool
    below: bool


def sheets(scenario: LoadedScenario, cells: pd.DataFrame, detail: bool = False) -> list[Sheet]:
    """Return the tables of the scenario that have cells, on as few sheets as they need.

    A sheet has a statistic and window, or, where these are more than the quantities, a quantity.
    ``detail`` adds to each figure its interval and its ratio to the bound.
    """
    found = []
    derived = derived_values(scenario, cells)
    marked = [CellKey(*row) in derived for row in cells[list(CellKey._fields)].to_numpy()]
    cells = cells.assign(
        mark=[DERIVED * is_marked for is_marked in marked],
        has_ratio=with_ratio(cells),
        below=below_bound(cells),
    )
    columns = zip(*(cells[name] for name in _Cell._fields))
    records: Any = [_Cell(*row) for row in columns]
    cells = cells.assign(record=records)
    for table in scenario.common.tables.layout:
        mine = (cells["table"] == table.table) & cells["quantity"].isin(table.quantities)
        mine &= cells["statistic"].isin(table.statistics) & cells["window"].isin(table.windows)
        chosen = cells[mine]
        if len(table.statistics) * len(table.windows) > len(table.quantities):
            parts = [chosen[chosen["quantity"] == name] for name in table.quantities]
            found += [_of_quantity(table, part, detail) for part in parts if len(part)]
            continue
        for column in product(table.statistics, table.windows):
            part = chosen[_in_column(chosen, column)]
            if len(part):
                found.append(_of_column(table, part, column, detail))
    return found


def _of_column(table: Table, cells: pd.DataFrame, column: tuple[str, str], detail: bool) -> Sheet:
    """Return the sheet of a statistic and window."""
    heads, rows = _grid(cells, detail)
    alone = f"{_heads(cells)[0]}, " if len(table.quantities) == 1 else ""
    return Sheet(table.table, f"{table.title}: {alone}{', '.join(column)}", heads, rows)


def _of_quantity(table: Table, cells: pd.DataFrame, detail: bool) -> Sheet:
    """Return the sheet of a quantity: statistics and windows side by side, sources below."""
    name = str(cells["quantity"].iloc[0])
    every = product(table.statistics, table.windows)
    columns = [column for column in every if _in_column(cells, column).any()]
    common = [same.pop() for each in zip(*columns) if len(same := set(each)) == 1]
    heads = [", ".join(part for part in each if part not in common) for each in columns]
    rows = [
        [
            str(case),
            _SHOWN.get(source, source),
            *(_text(rows_of, source, name, detail) for rows_of in by_column),
        ]
        for case, part in cells.groupby("case", sort=False)
        for by_column in [[list(part["record"][_in_column(part, each)]) for each in columns]]
        for source in _sources(part)
    ]
    title = ", ".join([f"{table.title}: {_heads(cells)[0]}", *common])
    return Sheet(table.table, title, ["case", "source", *heads], rows)


def _in_column(cells: pd.DataFrame, column: tuple[str, str]) -> pd.Series:
    return (cells["statistic"] == column[0]) & (cells["window"] == column[1])


def _grid(cells: pd.DataFrame, detail: bool) -> tuple[list[str], list[list[str]]]:
    """Sources side by side for a single quantity, one below the other for several or for words."""
    names = list(dict.fromkeys(cells["quantity"]))
    by_case = list(cells.groupby("case", sort=False))
    if len(names) == 1 and not cells["verdict"].isin(CONSISTENCY).any():
        sources = _sources(cells)
        rows = [
            [str(case), *(_text(rows_of, source, names[0], detail) for source in sources)]
            for case, part in by_case
            for rows_of in [list(part["record"])]
        ]
        return ["case", *(_SHOWN.get(source, source) for source in sources)], rows
    rows = [
        [str(case), _SHOWN.get(source, source)]
        + [_text(rows_of, source, name, detail) for name in names]
        for case, part in by_case
        for rows_of in [list(part["record"])]
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


def _text(rows: list[_Cell], source: str, quantity: str, detail: bool) -> str:
    """Return a figure of three digits, its verdict's sign, and before it the runs left out."""
    mine = [row for row in rows if row.quantity == quantity]
    if source == PAPER:
        published = [row for row in mine if pd.notna(row.published)]
        return "".join(f"{row.published:.3g}{row.mark}" for row in published[:1])
    own = next((row for row in mine if row.estimator == source), None)
    if own is None:
        return ""
    after = VOCABULARY[quantity].after_figure
    figure = f"{own.measured:.3g}{after}" if pd.notna(own.measured) else "-"
    lost = int(own.failed + own.diverged)
    note = f"({lost}) " if lost else ""
    more = _details(own) if detail else ""
    return f"{note}{figure}{more} {SYMBOLS[Verdict(own.verdict)]}".rstrip()


def _details(cell: _Cell) -> str:
    """Return the interval of a figure and its ratio to the bound, as far as they are known."""
    known = pd.notna(cell.ci_low) and pd.notna(cell.ci_high)
    interval = f" [{cell.ci_low:.3g}, {cell.ci_high:.3g}]" if known else ""
    doubt = BELOW if cell.below else ""
    return interval + (f" ×{cell.measured / cell.bound:.3g}{doubt}" if cell.has_ratio else "")


def with_ratio(cells: pd.DataFrame) -> pd.Series:
    """Return which cells are told with their ratio to the bound: sizes of errors that have one."""
    known = (cells["bound"] > 0) & (cells["measured"] != cells["bound"])
    return known & _sizes(cells)


def below_bound(cells: pd.DataFrame) -> pd.Series:
    """Return which of them are smaller than their bound by more than chance."""
    return with_ratio(cells) & (cells["ci_high"] < cells["bound"])


def without_bound(cells: pd.DataFrame) -> pd.Series:
    """Return which cells have a size of an error and no bound to set it against."""
    return _sizes(cells) & cells["bound"].isna()


def _sizes(cells: pd.DataFrame) -> pd.Series:
    """Return which cells have a size of an error, which a bound is about: no share, no square."""
    others = cells["statistic"].isin(SHARES) | cells["quantity"].isin(SQUARES)
    return cells["measured"].notna() & ~others
