"""Published values: a CSV beside the scenarios, with the verdict expected of each estimator.

Columns ``table, case, quantity, statistic, window, published, factor``, then one per estimator
with its expected verdict, alternatives separated by ``|``. ``factor`` is the tolerance factor.
A consistency, of which nothing is published, has neither, and is expected in words.
Of a value that is not printed itself, a column ``derived`` may say how it was made from what is.
"""

import csv
from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from debrisest.assessment.statistics import STATISTICS
from debrisest.errors import UserError, allowed_names, meant
from debrisest.files import MOST_BYTES, require_ending
from debrisest.results.runs import SIMULATED
from debrisest.scenario.load import LoadedScenario
from debrisest.scenario.window import window_of
from debrisest.show.tables.verdict import CONSISTENCY, Verdict
from debrisest.vocabulary import VOCABULARY

_COLUMNS = ("table", "case", "quantity", "statistic", "window", "published", "factor")
_DERIVED = "derived"


class CellKey(NamedTuple):
    """What tells a cell of the tables from the others, but for the estimator."""

    table: str
    case: str
    quantity: str
    statistic: str
    window: str


class Published(NamedTuple):
    """A published value, the factor within which it counts as reproduced, what we expect."""

    value: float | None
    factor: float
    expected: dict[str, list[Verdict]]
    derived: str = ""
    """How it was made from what is printed; empty: it is printed so."""


class PublishedFile(NamedTuple):
    """What a file of published values holds, and the line of each value."""

    path: Path
    estimators: list[str]
    values: dict[CellKey, Published]
    lines: dict[CellKey, int]


def published_values(scenario: LoadedScenario) -> dict[CellKey, Published]:
    """Return the published values that a scenario names, if it names any."""
    file = _published_file(scenario)
    return file.values if file else {}


def derived_values(scenario: LoadedScenario, cells: pd.DataFrame) -> dict[CellKey, str]:
    """Return how those of the cells' published values were made that are not printed so."""
    values = published_values(scenario).items()
    derived = {key: value.derived for key, value in values if value.derived}
    if not derived:
        return {}
    shown = set(zip(*(cells[name] for name in CellKey._fields)))
    return {key: how for key, how in derived.items() if key in shown}


def check_published(scenario: LoadedScenario) -> None:
    """Raise UserError for cells and estimators that a scenario does not have."""
    file = _published_file(scenario)
    if file is None:
        return
    known = [*scenario.common.estimators, SIMULATED]
    problems = [
        f"{file.path}:1: no estimator of {scenario.path} is called {name!r}; "
        f"{allowed_names(name, known)}"
        for name in file.estimators
        if name not in known
    ]
    for key, line in file.lines.items():
        if said := _unknown_cell(key, scenario):
            problems.append(f"{file.path}:{line}: {said}")
    if problems:
        raise UserError(problems)


def _published_file(scenario: LoadedScenario) -> PublishedFile | None:
    name = scenario.common.tables.published
    return load_published(scenario.path.parent / name) if name else None


def load_published(path: Path) -> PublishedFile:
    """Return the published values by cell, or raise UserError with every line that is wrong."""
    rows = _read(path)
    header = rows[0][1] if rows else []
    problems = [f"{path}:1: {said}" for said in _wrong_columns(header)]
    values: dict[CellKey, Published] = {}
    lines: dict[CellKey, int] = {}
    for line, row in rows[1:] if not problems else ():
        try:
            key, value = _parse(header, row)
            if lines.setdefault(key, line) != line:
                raise ValueError(f"this cell was given in line {lines[key]} already")
            values[key] = value
        except ValueError as error:
            problems.append(f"{path}:{line}: {error}")
    if problems:
        raise UserError(problems)
    return PublishedFile(path, [name for name in header if _estimator(name)], values, lines)


def _estimator(column: str) -> bool:
    return column not in (*_COLUMNS, _DERIVED)


def _read(path: Path) -> list[tuple[int, list[str]]]:
    """Return the rows that are not empty, with their lines."""
    try:
        require_ending(path, MOST_BYTES)
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = csv.reader(file)
            return [(rows.line_num, row) for row in rows if row]
    except OSError as error:
        others = (one.name for one in path.parent.glob("*.csv") if one.name != path.name)
        beside = meant(path.name, others)
        said = f"{path}: published values cannot be read: {error.strerror}{beside}"
        raise UserError(said) from None
    except (UnicodeDecodeError, csv.Error):
        raise UserError(f"{path}: published values must be a CSV file in UTF-8") from None


def _wrong_columns(header: list[str]) -> Iterator[str]:
    missing = [column for column in _COLUMNS if column not in header]
    if missing:
        yield f"missing column {', '.join(missing)}"
    for column in sorted({column for column in header if header.count(column) > 1}):
        yield f"the column {column!r} is there {header.count(column)} times"


def _parse(header: list[str], row: list[str]) -> tuple[CellKey, Published]:
    if len(row) != len(header):
        raise ValueError(f"this row has {len(row)} fields, the first line {len(header)}")
    named = dict(zip(header, row))
    key = CellKey(*(named[column] for column in CellKey._fields))
    value, factor = _value(named["published"], named["factor"])
    expected = {
        name: [_verdict(word) for word in words.split("|")]
        for name, words in named.items()
        if _estimator(name) and words
    }
    wrong = [v for said in expected.values() for v in said if (value is None) != (v in CONSISTENCY)]
    if wrong:
        told = "with a published value" if value is not None else "without a published value"
        raise ValueError(f"{wrong[0].value!r} is no verdict on a cell {told}")
    return key, Published(value, factor, expected, named.get(_DERIVED, ""))


def _value(published: str, factor: str) -> tuple[float | None, float]:
    """Return the value and its factor, None without either."""
    if not published and not factor:
        return None, 1.0
    value, tolerance = float(published), float(factor)
    if not (isfinite(value) and isfinite(tolerance) and value > 0 and tolerance >= 1):
        raise ValueError("published must be positive and factor at least 1, or both left out")
    return value, tolerance


def _verdict(word: str) -> Verdict:
    if word not in list(Verdict):
        raise ValueError(f"unknown verdict {word!r}; {allowed_names(word, Verdict)}")
    return Verdict(word)


def _unknown_cell(key: CellKey, scenario: LoadedScenario) -> str:
    """Return the field of a cell that no table of the scenario can have; nothing if there is none.

    What a table could show and does not is no mistake: a scenario may leave it out.
    """
    tables = scenario.common.tables
    layout = [table for table in tables.layout if table.table == key.table]
    known = {
        "table": [table.table for table in tables.layout],
        "case": [*scenario.cases, *tables.means],
        "quantity": [name for table in layout for name in table.quantities],
        "statistic": list(STATISTICS),
    }
    possible = known | {"quantity": [name for name, q in VOCABULARY.items() if q.table_unit]}
    for field, names in known.items():
        if (given := getattr(key, field)) not in possible[field]:
            return f"no {field} {given!r}; {allowed_names(given, dict.fromkeys(names))}"
    try:
        window_of(key.window, scenario.common.duration_s)
    except ValueError as error:
        return str(error)
    return ""
