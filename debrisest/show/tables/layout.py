"""Tables laid out as in the paper: a row per case, the sources side by side."""

from itertools import product
from math import isnan
from typing import NamedTuple

import pandas as pd

from debrisest.results.runs import SIMULATED
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.table_keys import Table
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

    table: str
    case: str
    quantity: str
    statistic: str
    window: str
    unit: str
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

    @property
    def column(self) -> tuple[str, str]:
        """Return its statistic and window."""
        return self.statistic, self.window


def sheets(scenario: LoadedScenario, cells: pd.DataFrame, detail: bool = False) -> list[Sheet]:
    """Return the tables of the scenario that have cells, on as few sheets as they need.

    A sheet has a statistic and window, or, where these are more than the quantities, a quantity.
    ``detail`` adds to each figure its interval and its ratio to the bound.
    """
    found, every = [], _records(scenario, cells)
    for table in scenario.common.tables.layout:
        columns = list(product(table.statistics, table.windows))
        mine = (one for one in every if one.table == table.table and one.column in columns)
        chosen = [one for one in mine if one.quantity in table.quantities]
        if len(columns) > len(table.quantities):
            parts = [[one for one in chosen if one.quantity == name] for name in table.quantities]
            found += [_of_quantity(table, part, detail) for part in parts if part]
            continue
        for column in columns:
            part = [one for one in chosen if one.column == column]
            if part:
                found.append(_of_column(table, part, column, detail))
    return found


def _records(scenario: LoadedScenario, cells: pd.DataFrame) -> list[_Cell]:
    derived = derived_values(scenario, cells)
    marked = [CellKey(*row) in derived for row in cells[list(CellKey._fields)].to_numpy()]
    cells = cells.assign(
        mark=[DERIVED * is_marked for is_marked in marked],
        has_ratio=with_ratio(cells),
        below=below_bound(cells),
    )
    return [_Cell(*row) for row in zip(*(cells[name].tolist() for name in _Cell._fields))]


def _of_column(table: Table, cells: list[_Cell], column: tuple[str, str], detail: bool) -> Sheet:
    """Return the sheet of a statistic and window."""
    heads, rows = _grid(cells, detail)
    alone = f"{_heads(cells)[0]}, " if len(table.quantities) == 1 else ""
    return Sheet(table.table, f"{table.title}: {alone}{', '.join(column)}", heads, rows)


def _of_quantity(table: Table, cells: list[_Cell], detail: bool) -> Sheet:
    """Return the sheet of a quantity: statistics and windows side by side, sources below."""
    name, there = cells[0].quantity, {one.column for one in cells}
    columns = [each for each in product(table.statistics, table.windows) if each in there]
    common = [same.pop() for each in zip(*columns) if len(same := set(each)) == 1]
    heads = [", ".join(part for part in each if part not in common) for each in columns]
    rows = [
        [
            case,
            _SHOWN.get(source, source),
            *(_text(rows_of, source, name, detail) for rows_of in by_column),
        ]
        for case, part in _by_case(cells)
        for by_column in [[[one for one in part if one.column == each] for each in columns]]
        for source in _sources(part)
    ]
    title = ", ".join([f"{table.title}: {_heads(cells)[0]}", *common])
    return Sheet(table.table, title, ["case", "source", *heads], rows)


def _by_case(cells: list[_Cell]) -> list[tuple[str, list[_Cell]]]:
    found: dict[str, list[_Cell]] = {}
    for one in cells:
        found.setdefault(one.case, []).append(one)
    return list(found.items())


def _grid(cells: list[_Cell], detail: bool) -> tuple[list[str], list[list[str]]]:
    """Sources side by side for a single quantity, one below the other for several or for words."""
    names = list(dict.fromkeys(one.quantity for one in cells))
    by_case = _by_case(cells)
    if len(names) == 1 and not any(one.verdict in CONSISTENCY for one in cells):
        sources = _sources(cells)
        rows = [
            [case, *(_text(part, source, names[0], detail) for source in sources)]
            for case, part in by_case
        ]
        return ["case", *(_SHOWN.get(source, source) for source in sources)], rows
    rows = [
        [case, _SHOWN.get(source, source)] + [_text(part, source, name, detail) for name in names]
        for case, part in by_case
        for source in _sources(part)
    ]
    return ["case", "source", *_heads(cells)], rows


def _heads(cells: list[_Cell]) -> list[str]:
    """Return the quantities with their units."""
    pairs = dict.fromkeys((one.quantity, one.unit) for one in cells)
    return [f"{name} ({unit})" if unit != "1" else name for name, unit in pairs]


def _sources(cells: list[_Cell]) -> list[str]:
    paper = [PAPER] if any(_is_known(one.published) for one in cells) else []
    return [*paper, *dict.fromkeys(one.estimator for one in cells)]


def _text(rows: list[_Cell], source: str, quantity: str, detail: bool) -> str:
    """Return a figure of three digits, its verdict's sign, and before it the runs left out."""
    mine = [row for row in rows if row.quantity == quantity]
    if source == PAPER:
        published = [row for row in mine if _is_known(row.published)]
        return "".join(f"{row.published:.3g}{row.mark}" for row in published[:1])
    own = next((row for row in mine if row.estimator == source), None)
    if own is None:
        return ""
    after = VOCABULARY[quantity].after_figure
    figure = f"{own.measured:.3g}{after}" if _is_known(own.measured) else "-"
    lost = int(own.failed + own.diverged)
    note = f"({lost}) " if lost else ""
    more = _details(own) if detail else ""
    return f"{note}{figure}{more} {SYMBOLS[Verdict(own.verdict)]}".rstrip()


def _is_known(figure: float | None) -> bool:
    return figure is not None and not isnan(figure)


def _details(cell: _Cell) -> str:
    """Return the interval of a figure and its ratio to the bound, as far as they are known."""
    known = _is_known(cell.ci_low) and _is_known(cell.ci_high)
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
