"""Read scenario files: cases, grids and overrides, every problem told at once."""

import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import reduce
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from debrisest.catalog import required_keys
from debrisest.errors import UserError, allowed_names, meant
from debrisest.plugins.load import Plugin, load_plugins
from debrisest.scenario.case import Case
from debrisest.scenario.checks import case_problems, file_problems
from debrisest.scenario.document import (
    Document,
    KeyPath,
    Place,
    Problem,
    merge,
    parse,
    sub_document,
)
from debrisest.scenario.limits import extreme_numbers
from debrisest.scenario.measured import told_by_data
from debrisest.scenario.mistakes import NAMED, validated
from debrisest.scenario.names import case_name_problems, check_scenario_name
from debrisest.scenario.schema import CasesAndGrid, Scenario, scenario_model

NOMINAL = "nominal"
"""The case of a scenario that has neither cases nor a grid."""


MOST_BYTES = 20_000_000


class LoadedScenario(NamedTuple):
    """A scenario file and all its cases, in the order of the file."""

    path: Path
    cases: dict[str, Case]
    variant: str = ""

    @property
    def name(self) -> str:
        """Return the scenario's name, the stem of its file, and that of its variant."""
        return f"{self.path.stem}@{self.variant}" if self.variant else self.path.stem

    def called(self, variant: str) -> "LoadedScenario":
        """Return the same with results of its own, beside those of other variants."""
        found = self._replace(variant=variant)
        cases = {
            name: replace(case, scenario_name=found.name).known_as(case.scenario)
            for name, case in self.cases.items()
        }
        return found._replace(cases=cases)

    @property
    def common(self) -> Scenario:
        """Return one case's scenario, for what does not differ between cases."""
        return next(iter(self.cases.values())).scenario

    @property
    def missing_libraries(self) -> list[str]:
        """Return the libraries that a part of any case needs and that are not installed."""
        needed = {name for case in self.cases.values() for name in case.scenario.libraries}
        return sorted(name for name in needed if find_spec(name) is None)


def load_scenario(
    path: Path, overrides: Sequence[str] = (), plugins: tuple[Plugin, ...] = ()
) -> LoadedScenario:
    """Return the cases of a scenario file, or raise UserError with every problem of it."""
    check_scenario_name(path)
    loaded = load_plugins(plugins)
    document, problems = parse(_read(path), str(path))
    if problems and not document.value:
        raise UserError(map(str, problems))
    laid_on = [_override(text, document) for text in overrides]
    given = [document, *laid_on]
    extreme = [p for one in given for p in _placed(one, extreme_numbers(one.value))]
    if extreme:
        raise UserError(dict.fromkeys(map(str, [*problems, *extreme])))
    own: dict[str, Any] = {k: v for k, v in document.value.items() if k in ("cases", "grid")}
    listed, found = validated(Document(own, document.places), CasesAndGrid, path.parent)
    problems += found
    cases: dict[str, Case] = {}
    layers_of = _layers_of_cases(document, listed or CasesAndGrid())
    problems += _placed(document, _case_name_problems(layers_of, listed or CasesAndGrid()))
    for name, layers in layers_of.items():
        complete, wrong = told_by_data(reduce(_laid_on, [*layers, *laid_on]), path.parent)
        scenario, found = validated(complete, scenario_model(), path.parent)
        problems += wrong + found
        if scenario is not None and not wrong:
            case = Case(path.stem, name, complete.value, path.parent.absolute(), loaded)
            cases[name] = case.known_as(scenario)
            problems += _placed(complete, case_problems(cases[name]))
    if not problems:
        problems = _placed(document, file_problems(cases))
    if problems:
        raise UserError(dict.fromkeys(map(str, problems)))
    return LoadedScenario(path, cases)


def _laid_on(base: Document, over: Document) -> Document:
    return merge(base, over, required_keys)


def _read(path: Path) -> str:
    try:
        with path.open("rb") as file:
            raw = file.read(MOST_BYTES + 1)
    except IsADirectoryError:
        raise UserError(f"{path}: this is a folder; give a scenario file (YAML)") from None
    except OSError as error:
        reason = error.strerror or "cannot be read"
        beside = meant(path.name, (one.name for one in path.parent.glob("*.yaml")))
        raise UserError(
            f"{path}: {reason}; give the path of a scenario file (YAML){beside}"
        ) from None
    if len(raw) > MOST_BYTES:
        raise UserError(f"{path}: over {MOST_BYTES // 10**6} MB; give a scenario file (YAML)")
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError as error:
        raise UserError(
            f"{path}: not a text file (byte {error.start} is not UTF-8); "
            "give a scenario file (YAML)"
        ) from None


def _override(text: str, document: Document) -> Document:
    key, equals, value = text.partition("=")
    if not equals or not all(key.split(".")):
        raise UserError(f"--set {text}: expected key.path=value, such as runs=5")
    place = Place(f"--set {text}")
    parsed, problems = parse(f"value: {value}", place.source)
    if problems:
        raise UserError(f"{place}: the value is not valid YAML")
    if key.split(".")[0] in ("cases", "grid"):
        raise UserError(f"{place}: cases and grid cannot be set, since --set goes on every case")
    role, *named = key.split(".")
    for varied in document.value.get("grid") or {}:
        if f"{varied}.".startswith(f"{key}.") or f"{key}.".startswith(f"{varied}."):
            raise UserError(f"{place}: the grid varies {varied} and names its cases after it")
    known = document.value.get(role)
    if role in NAMED and isinstance(known, dict) and named and named[0] not in known:
        raise UserError(f"{place}: unknown name {named[0]!r}; {allowed_names(named[0], known)}")
    return _nested(tuple(key.split(".")), parsed.value["value"], place)


def _placed(document: Document, found: Iterable[tuple[KeyPath, str]]) -> list[Problem]:
    return [
        Problem(document.place(path), f"{'.'.join(map(str, path))}: {message}")
        for path, message in found
    ]


def _layers_of_cases(document: Document, listed: CasesAndGrid) -> dict[str, list[Document]]:
    """Return what is laid on each other for every case, grid and cases multiplied out."""
    base = Document(
        {key: value for key, value in document.value.items() if key not in ("cases", "grid")},
        document.places,
    )
    cases = {name: [base, sub_document(document, ("cases", name))] for name in listed.cases}
    if not listed.grid:
        return cases or {NOMINAL: [base]}
    points = [_grid_point(document, point) for point in _combinations(listed.grid)]
    names = [name for name, _ in points]
    if len(set(names)) < len(names):
        raise UserError(f"{document.place(('grid',))}: two points of the grid have one name")
    if not cases:
        return {name: [base, over] for name, over in points}
    return {
        f"{case},{name}": [*layers, over] for case, layers in cases.items() for name, over in points
    }


def _case_name_problems(
    documents: Iterable[str], listed: CasesAndGrid
) -> Iterator[tuple[KeyPath, str]]:
    for name, why in case_name_problems(documents):
        yield ("cases", name) if name in listed.cases else ("grid",), why


def _combinations(grid: dict[str, list[Any]]) -> list[dict[str, Any]]:
    return [dict(zip(grid, values)) for values in itertools.product(*grid.values())]


def _grid_point(document: Document, point: dict[str, Any]) -> tuple[str, Document]:
    """Return the name of a point of the grid, and what it lays on the scenario."""
    name = ",".join(f"{key.rsplit('.', 1)[-1]}={value}" for key, value in point.items())
    value: dict[str, Any] = {}
    places: dict[KeyPath, Place] = {}
    for key, at in point.items():
        over = _nested(tuple(key.split(".")), at, document.place(("grid", key)))
        merged = merge(Document(value, places), over)
        value, places = merged.value, merged.places
    return re.sub(r"[^A-Za-z0-9_.+=,-]", "", name), Document(value, places)


def _nested(path: tuple[str, ...], value: Any, place: Place) -> Document:
    places: dict[KeyPath, Place] = {path[: depth + 1]: place for depth in range(len(path))}
    for name in reversed(path):
        value = {name: value}
    return Document(value, places)
