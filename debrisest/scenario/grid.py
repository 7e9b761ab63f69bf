"""The points of a scenario's grid: what each is called, and which of them are one truth."""

import itertools
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from debrisest.scenario.document import Document, merge, nested
from debrisest.scenario.names import UNNAMED

NOT_SIMULATED = ("estimators", "tables")
"""What a grid can vary without another simulation."""

Grid = dict[str, list[Any]]


class Point(NamedTuple):
    """A combination of the grid's values."""

    name: str
    simulated_as: str
    """The name without what no simulation reads: points that share it share their simulation."""
    laid: Document
    """What is laid on the scenario."""
    values: dict[str, Any]
    """The value of each key, a part or a list in words."""


def points(document: Document, grid: Grid) -> list[Point]:
    """Return every combination of a grid's values, in their order."""
    labels = _labels(grid)
    combinations = itertools.product(*(range(len(values)) for values in grid.values()))
    return [_point(document, grid, labels, dict(zip(grid, chosen))) for chosen in combinations]


def _point(
    document: Document, grid: Grid, labels: dict[str, list[str]], chosen: dict[str, int]
) -> Point:
    laid = Document({})
    for key, index in chosen.items():
        place = document.place(("grid", key))
        laid = merge(laid, nested(tuple(key.split(".")), grid[key][index], place))
    told = {key: labels[key][index] for key, index in chosen.items()}
    truth = (text for key, text in told.items() if key.split(".")[0] not in NOT_SIMULATED)
    values = {key: _told(grid[key][index], index, grid[key]) for key, index in chosen.items()}
    return Point(",".join(told.values()), ",".join(truth), laid, values)


def _labels(grid: Grid) -> dict[str, list[str]]:
    """Return what names say of each value of each key."""
    return {
        key: [
            UNNAMED.sub("", f"{_short(key, grid)}={_text(value, index, values)}")
            for index, value in enumerate(values)
        ]
        for key, values in grid.items()
    }


def _short(key: str, keys: Iterable[str]) -> str:
    """Return the last part of a key path, after the nearest that others with this end lack."""
    *above, last = key.split(".")
    paths = [other.split(".") for other in keys if other != key]
    alike = [path for path in paths if path[-1] == last]
    own = [part for part in reversed(above) if not any(part in path for path in alike)]
    return ".".join([*own[: bool(alike)], last]) if own or not alike else key


def _told(value: Any, index: int, values: Sequence[Any]) -> Any:
    return _text(value, index, values) if isinstance(value, dict | list) else value


def _text(value: Any, index: int, values: Sequence[Any]) -> str:
    """Return a value in words: a part by its kind, where several have it with their numbers."""
    if not isinstance(value, dict):
        return str(value)
    kind = str(value.get("kind", ""))
    alike = sum(isinstance(one, dict) and one.get("kind") == value.get("kind") for one in values)
    return kind if kind and alike == 1 else f"{kind}-{index + 1}".strip("-")
