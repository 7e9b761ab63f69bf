"""Read scenario files: cases, grids and overrides, every problem told at once."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import reduce
from importlib.util import find_spec
from math import prod
from pathlib import Path
from typing import Any, NamedTuple

from debrisest.catalog import required_keys
from debrisest.errors import UserError, allowed_names, meant
from debrisest.files import MOST_BYTES, require_ending
from debrisest.plugins.load import Plugin, load_plugins
from debrisest.scenario.case import Case
from debrisest.scenario.checks import case_problems, file_problems
from debrisest.scenario.document import (
    Document,
    KeyPath,
    Place,
    Problem,
    merge,
    nested,
    parse,
    sub_documents,
)
from debrisest.scenario.grid import points
from debrisest.scenario.limits import extreme_numbers
from debrisest.scenario.measured import told_by_data
from debrisest.scenario.mistakes import NAMED, validated
from debrisest.scenario.models import scenario_model
from debrisest.scenario.names import VARIANT, case_name_problems, check_scenario_name
from debrisest.scenario.schema import CasesAndGrid, Scenario

MOST_CASES = 50_000
NOMINAL = "nominal"
"""The case of a scenario that has neither cases nor a grid."""


class LoadedScenario(NamedTuple):
    """A scenario file and all its cases, in the order of the file."""

    path: Path
    cases: dict[str, Case]
    variant: str = ""
    grid: dict[str, dict[str, Any]] = {}
    """What a grid gives each case: values by their keys."""

    @property
    def name(self) -> str:
        """Return the scenario's name, the stem of its file, and that of its variant."""
        return f"{self.path.stem}{VARIANT}{self.variant}" if self.variant else self.path.stem

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
    own = {k: v for k, v in document.value.items() if k in CasesAndGrid.model_fields}
    listed, found = validated(Document(own, document.places), CasesAndGrid, path.parent)
    problems += found
    cases: dict[str, Case] = {}
    layers_of = _layers_of_cases(document, listed or CasesAndGrid())
    problems += _placed(document, _case_name_problems(layers_of, listed or CasesAndGrid()))
    for name, (simulated_as, layers, _) in layers_of.items():
        complete, wrong = told_by_data(reduce(_laid_on, [*layers, *laid_on]), path.parent)
        scenario, found = validated(complete, scenario_model(), path.parent)
        problems += wrong + found
        if scenario is not None and not wrong:
            folder = path.parent.absolute()
            case = Case(path.stem, name, complete.value, folder, loaded, simulated_as)
            cases[name] = case.known_as(scenario)
            problems += _placed(complete, case_problems(cases[name]))
    if not problems:
        problems = _placed(document, file_problems(cases))
    if problems:
        raise UserError(dict.fromkeys(map(str, problems)))
    grid = {name: layers.values for name, layers in layers_of.items() if layers.values}
    return LoadedScenario(path, cases, grid=grid)


def _laid_on(base: Document, over: Document) -> Document:
    return merge(base, over, required_keys)


def _read(path: Path) -> str:
    try:
        require_ending(path, MOST_BYTES)
        raw = path.read_bytes()
    except IsADirectoryError:
        raise UserError(f"{path}: this is a folder; give a scenario file (YAML)") from None
    except OSError as error:
        reason = error.strerror or "cannot be read"
        others = (one.name for one in path.parent.glob("*.yaml") if one.name != path.name)
        beside = meant(path.name, others)
        raise UserError(
            f"{path}: {reason}; give the path of a scenario file (YAML){beside}"
        ) from None
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
    role, *named = key.split(".")
    if role in CasesAndGrid.model_fields:
        raise UserError(f"{place}: {role} cannot be set, since --set goes on every case")
    for varied in document.value.get("grid") or {}:
        if f"{varied}.".startswith(f"{key}.") or f"{key}.".startswith(f"{varied}."):
            raise UserError(f"{place}: the grid varies {varied} and names its cases after it")
    known = document.value.get(role)
    if role in NAMED and isinstance(known, dict) and named and named[0] not in known:
        raise UserError(f"{place}: unknown name {named[0]!r}; {allowed_names(named[0], known)}")
    return nested(tuple(key.split(".")), parsed.value["value"], place)


def _placed(document: Document, found: Iterable[tuple[KeyPath, str]]) -> list[Problem]:
    return [
        Problem(document.place(path), f"{'.'.join(map(str, path))}: {message}")
        for path, message in found
    ]


class _Layers(NamedTuple):
    """What is laid on each other for a case."""

    simulated_as: str
    documents: list[Document]
    values: dict[str, Any] = {}


def _layers_of_cases(document: Document, listed: CasesAndGrid) -> dict[str, _Layers]:
    """Return the layers of every case, grid and cases multiplied out."""
    own = CasesAndGrid.model_fields
    base = Document(
        {key: value for key, value in document.value.items() if key not in own},
        {path: place for path, place in document.places.items() if not {*path[:1]} & {*own}},
    )
    changes = sub_documents(document, "cases") if listed.cases else {}
    cases = {name: [base, changes[name]] for name in listed.cases} or {NOMINAL: [base]}
    if not listed.grid:
        return {name: _Layers(name, documents) for name, documents in cases.items()}
    count = len(cases) * prod(map(len, listed.grid.values()))
    if count > MOST_CASES:
        told = (
            f"grid: makes {count} cases, and at most {MOST_CASES} are possible; vary fewer values"
        )
        raise UserError(f"{document.place(('grid',))}: {told}")
    grid = points(document, listed.grid)
    if len({point.name for point in grid}) < len(grid):
        raise UserError(f"{document.place(('grid',))}: two points of the grid have one name")
    found: dict[str, _Layers] = {}
    for case, documents in cases.items():
        prefix = [case] if listed.cases else []
        shared = [Document({"draws": case})] if listed.common_draws else []
        for point in grid:
            truth = ",".join([*prefix, *filter(None, [point.simulated_as])]) or case
            name = ",".join([*prefix, point.name])
            found[name] = _Layers(truth, [*shared, *documents, point.laid], point.values)
    return found


def _case_name_problems(
    layers_of: dict[str, _Layers], listed: CasesAndGrid
) -> Iterator[tuple[KeyPath, str]]:
    truths = [layers.simulated_as for layers in layers_of.values()]
    for name, why in case_name_problems(dict.fromkeys([*layers_of, *truths])):
        yield ("cases", name) if name in listed.cases else ("grid",), why
