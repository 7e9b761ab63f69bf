"""Published values: a CSV beside the scenarios, with the verdict expected of each estimator.

Columns ``table, case, quantity, statistic, window, published, factor``, then one per estimator
with its expected verdict, alternatives separated by ``|``. ``factor`` is the tolerance factor.
"""

import csv
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

from debrisest.errors import UserError
from debrisest.scenario.load import LoadedScenario
from debrisest.show.tables.verdict import Verdict

_COLUMNS = ("table", "case", "quantity", "statistic", "window", "published", "factor")


class CellKey(NamedTuple):
    """What tells a cell of the tables from the others, but for the estimator."""

    table: str
    case: str
    quantity: str
    statistic: str
    window: str


class Published(NamedTuple):
    """A published value, the factor within which it counts as reproduced, what we expect."""

    value: float
    factor: float
    expected: dict[str, list[Verdict]]


def published_values(scenario: LoadedScenario) -> dict[CellKey, Published]:
    """Return the published values that a scenario names, if it names any."""
    file = scenario.common.tables.published
    return load_published(scenario.path.parent / file) if file else {}


def load_published(path: Path) -> dict[CellKey, Published]:
    """Return the published values by cell, or raise UserError with the line that is wrong."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = csv.DictReader(file)
            fields = rows.fieldnames or []
            missing = [column for column in _COLUMNS if column not in fields]
            if missing:
                raise UserError(f"{path}:1: missing column {', '.join(missing)}")
            return dict(_parse(path, rows.line_num, row) for row in rows)
    except OSError as error:
        raise UserError(f"{path}: published values cannot be read: {error.strerror}") from None
    except (UnicodeDecodeError, csv.Error):
        raise UserError(f"{path}: published values must be a CSV file in UTF-8") from None


def _parse(path: Path, line: int, row: dict[Any, Any]) -> tuple[CellKey, Published]:
    if None in row or None in row.values():
        raise UserError(f"{path}:{line}: this row has more or fewer fields than the first line")
    key = CellKey(*(row[column] for column in CellKey._fields))
    try:
        value, factor = float(row["published"]), float(row["factor"])
        if not (isfinite(value) and isfinite(factor) and value > 0 and factor >= 1):
            raise ValueError("published must be positive and factor at least 1")
        expected = {
            name: [Verdict(word) for word in words.split("|")]
            for name, words in row.items()
            if name not in _COLUMNS and words
        }
    except ValueError as error:
        raise UserError(f"{path}:{line}: {error}") from None
    return key, Published(value, factor, expected)
