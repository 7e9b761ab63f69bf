"""A text file split into cells: CSV with commas, semicolons or tabs.

The first line that is neither blank nor a comment (``#``) names the columns; their delimiter is the
one between these names, and every further line has as many fields.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from debrisest.arrays import IntArray
from debrisest.errors import UserError
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
