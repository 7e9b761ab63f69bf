"""The one reader of tables in text: CSV with commas, semicolons or tabs, and nothing guessed.

The first line that is neither blank nor a comment (``#``) names the columns; their delimiter is the
one between these names. Decimal commas are read where the delimiter is not a comma; both marks in
one file are refused. What was understood is told in `Sheet.notes` and `Table.notes`.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from debrisest.arrays import Array, BoolArray, IntArray
from debrisest.errors import UserError
from debrisest.tracks.columns import Layout, check_names
from debrisest.tracks.numbers import to_numbers, wrong_number
from debrisest.tracks.report import Report
from debrisest.tracks.text import read_text

_DELIMITERS = {",": "commas", ";": "semicolons", "\t": "tabs"}


@dataclass(frozen=True)
class Sheet:
    """Cells as text: columns' names, rows of as many fields, and the line of each row."""

    source: str
    line: int
    names: tuple[str, ...]
    delimiter: str
    rows: list[list[str]]
    lines: IntArray
    notes: tuple[str, ...]


@dataclass(frozen=True)
class Table:
    """Columns by name: numbers ``(row,)``, NaN for an empty cell, texts, the rows' lines."""

    numbers: dict[str, Array]
    texts: dict[str, list[str]]
    lines: IntArray
    notes: tuple[str, ...]


def open_sheet(path: Path) -> Sheet:
    """Split a file into cells. Raises `UserError` with every line that does not fit the header."""
    text, report = read_text(path), Report(str(path))
    numbered = [
        (number, line)
        for number, line in enumerate(text.split("\n"), 1)
        if (bare := line.strip()) and bare[0] != "#"
    ]
    if not numbered:
        raise UserError(f"{path}: the file holds comments only")
    (line, header), *body = numbered
    delimiter = _delimiter(header, f"{path}:{line}")
    names = tuple(name.strip() for name in _split(header, delimiter, line, report))
    rows = [_split(text, delimiter, number, report) for number, text in body]
    lines = np.array([number for number, _ in body], dtype=np.int64)
    wrong = np.array([len(row) for row in rows], dtype=np.int64) != len(names)
    report.where(wrong, lines, lambda row: _count(body[row][1], rows[row], names, delimiter))
    report.check()
    if not rows:
        raise UserError(f"{path}:{line}: there is a header, but no row of data below it")
    notes = [f"columns separated by {_DELIMITERS[delimiter]}"]
    if not text.endswith("\n"):
        notes.append(f"line {lines[-1]} has no line end: see that the file was not cut there")
    return Sheet(str(path), line, names, delimiter, rows, lines, tuple(notes))


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


def _delimiter(header: str, place: str) -> str:
    bare = "".join(header.split('"')[::2])
    found = [delimiter for delimiter in _DELIMITERS if delimiter in bare]
    if len(found) == 1:
        return found[0]
    if found:
        kinds = " and ".join(_DELIMITERS[delimiter] for delimiter in found)
        raise UserError(f"{place}: the header has {kinds}; separate all columns by one of them")
    message = "one column only; separate the columns by commas, semicolons or tabs"
    raise UserError(f"{place}: the header {header[:60]!r} has {message}")


def _split(text: str, delimiter: str, number: int, report: Report) -> list[str]:
    if '"' not in text:
        return text.split(delimiter)
    try:
        return next(csv.reader([text], delimiter=delimiter, strict=True, skipinitialspace=True))
    except csv.Error:
        report.add(number, 'a quotation mark is not closed; write "name" or leave the marks out')
        report.check()
        return []


def _count(text: str, row: list[str], names: tuple[str, ...], delimiter: str) -> str:
    said = f"{len(row)} fields, the header has {len(names)}"
    others = [word for mark, word in _DELIMITERS.items() if mark != delimiter and mark in text]
    if others and len(row) < len(names):
        return f"{said}: it is separated by {_DELIMITERS[delimiter]}, this line by {others[0]}"
    if len(row) < len(names):
        return f"{said}; leave a cell empty between two delimiters where nothing was observed"
    if delimiter == ",":
        return f"{said}; decimal commas need semicolons between the columns, or write 1.5"
    return f"{said}; remove the cells without a column"


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
