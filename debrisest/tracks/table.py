"""The one reader of tables: the cells of a sheet as numbers and texts, and nothing guessed.

Decimal commas are read where the delimiter is not a comma; both marks in one file are refused. What
was understood is told in `Table.notes`.
"""

from dataclasses import dataclass

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.tracks.columns import Layout, check_names
from debrisest.tracks.numbers import to_numbers, wrong_number
from debrisest.tracks.report import Report
from debrisest.tracks.sheet import Sheet


@dataclass(frozen=True)
class Table:
    """Columns by name: numbers ``(row,)``, NaN for an empty cell, texts, the rows' lines."""

    numbers: dict[str, Array]
    texts: dict[str, list[str]]
    lines: IntArray
    notes: tuple[str, ...]


def read_table(sheet: Sheet, layout: Layout) -> Table:
    """Read the columns of a sheet as a layout has them.

    Raises `UserError`: unknown, double or missing columns, cells that are no numbers, cells that
    are empty where `Layout.gaps` does not allow it; each with file, line and column.
    """
    report = Report(sheet.source)
    check_names(sheet.names, sheet.line, layout, report)
    cells = {name: list(column) for name, column in zip(sheet.names, zip(*sheet.rows))}
    texts = {
        name: [c.strip() for c in cells.pop(name)] for name in sheet.names if name in layout.texts
    }
    decimal, notes = _decimal(sheet, cells, report)
    numbers = {}
    for name, fields in cells.items():
        numbers[name], wrong = to_numbers(fields, decimal)
        _check_numbers(name, fields, numbers[name], wrong, decimal, sheet, layout, report)
    for name, fields in texts.items():
        _check_texts(name, fields, sheet, layout, report)
    report.check()
    return Table(numbers, texts, sheet.lines, sheet.notes + notes)


def _decimal(
    sheet: Sheet, cells: dict[str, list[str]], report: Report
) -> tuple[str, tuple[str, ...]]:
    """Decimal mark of all numbers of a sheet, and what to tell of it."""
    if sheet.delimiter == ",":
        return ".", ("decimal points",)
    comma, point = _first(",", cells, sheet.lines), _first(".", cells, sheet.lines)
    if comma and point:
        said = f"decimal comma ({comma[0]}), but a point in line {point[1]} ({point[0]})"
        report.add(comma[1], f"{said}: use one of them, without separators of thousands")
        report.check()
    if comma:
        return ",", (f"decimal commas: {comma[0]} is read as {comma[0].replace(',', '.')}",)
    return ".", ("decimal points",)


def _first(mark: str, cells: dict[str, list[str]], lines: IntArray) -> tuple[str, int] | None:
    found = (
        (index, cell.strip()[:30])
        for column in cells.values()
        for index, cell in enumerate(column)
        if mark in cell
    )
    first = next(found, None)
    return (first[1], int(lines[first[0]])) if first else None


def _check_numbers(
    name: str, fields: list[str], values: Array, wrong: BoolArray, decimal: str,
    sheet: Sheet, layout: Layout, report: Report,
) -> None:  # fmt: skip
    delimiter = sheet.delimiter
    say = lambda row: wrong_number(fields[row], decimal, delimiter)  # noqa: E731
    report.where(wrong, sheet.lines, say, name)
    if name not in layout.gaps:
        message = "empty; every row needs it"
        report.where(np.isnan(values) & ~wrong, sheet.lines, message, name)


def _check_texts(
    name: str, fields: list[str], sheet: Sheet, layout: Layout, report: Report
) -> None:
    odd = {text for text in set(fields) if not text.isprintable() or '"' in text}
    if odd:
        wrong = np.array([text in odd for text in fields])
        report.where(wrong, sheet.lines, lambda row: f"{fields[row]!r} is not a name", name)
    if name not in layout.gaps and "" in fields:
        empty = np.array([text == "" for text in fields])
        report.where(empty, sheet.lines, "empty; every row needs it", name)
