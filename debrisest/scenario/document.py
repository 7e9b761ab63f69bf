"""A YAML file as plain data in which the place of every key is known.

Stricter than YAML 1.1: duplicate keys are problems, ``1e-6`` is a number, only ``true`` and
``false`` are booleans, keys are text, and dates and base-60 numbers do not exist.
"""

import re
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import yaml

KeyPath = tuple[str | int, ...]


class Place(NamedTuple):
    """Where something was written."""

    source: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        """Return ``file:line:column``, or the source alone where it has no lines."""
        return f"{self.source}:{self.line}:{self.column}" if self.line else self.source


class Problem(NamedTuple):
    """One thing that is wrong with the input, and where."""

    place: Place
    message: str

    def __str__(self) -> str:
        """Return the line that is shown to the user."""
        return f"{self.place}: {self.message}"


@dataclass(frozen=True)
class Document:
    """Plain data with the place of each key path."""

    value: dict[str, Any]
    places: dict[KeyPath, Place] = field(default_factory=dict)

    def place(self, path: KeyPath) -> Place:
        """Return the place of a key path, or of its nearest parent that was written down."""
        while path not in self.places and path:
            path = path[:-1]
        return self.places.get(path, Place("scenario"))


class _Loader(yaml.SafeLoader):
    yaml_implicit_resolvers: dict[Any, Any] = {}


for _tag, _pattern, _first in (
    ("bool", r"true|false", "tf"),
    ("null", r"null|~|", ["n", "~", ""]),
    ("int", r"[-+]?(0|[1-9][0-9]*)", "-+0123456789"),
    ("float", r"[-+]?([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+)([eE][-+]?[0-9]+)?", "-+.0123456789"),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_tag}", re.compile(f"^(?:{_pattern})$"), list(_first)
    )


def parse(text: str, source: str) -> tuple[Document, list[Problem]]:
    """Parse YAML text whose top level is a mapping; ``source`` names it in messages."""
    start = Place(source, 1, 1)
    problems: list[Problem] = []
    places: dict[KeyPath, Place] = {(): start}
    try:
        loader = _Loader(text)
        node = loader.get_single_node()
        value = _construct(loader, node, (), places, problems, source)
    except yaml.MarkedYAMLError as error:
        return Document({}, places), [Problem(_place(source, error.problem_mark), _said(error))]
    except RecursionError:
        return Document({}, places), [Problem(start, "not valid YAML: nested too deeply")]
    except yaml.YAMLError as error:
        return Document({}, places), [Problem(start, f"not a YAML text: {error}".split("\n")[0])]
    if not isinstance(value, dict):
        found = "the file is empty" if value is None else f"found {value!r}"[:60]
        message = f"expected a mapping of keys (title, seed, target, ...), {found}"
        return Document({}, places), [*problems, Problem(start, message)]
    return Document(value, places), problems


def merge(base: Document, over: Document) -> Document:
    """Return ``base`` with ``over`` laid on it: mappings merge key by key, the rest is replaced.

    A mapping of another ``kind`` replaces the base's, since the keys of a kind are its own.
    """
    places = {path: place for path, place in over.places.items() if path}
    return Document(_merge_values(base.value, over.value), base.places | places)


def sub_document(document: Document, path: KeyPath) -> Document:
    """Return the mapping at ``path`` as a document of its own, keeping the places."""
    value: Any = document.value
    for key in path:
        value = value[key]
    depth = len(path)
    places = {p[depth:]: at for p, at in document.places.items() if p[:depth] == path}
    return Document(value if isinstance(value, dict) else {}, places)


def _merge_values(base: Any, over: Any) -> Any:
    if not (isinstance(base, dict) and isinstance(over, dict)):
        return over
    if "kind" in over and over["kind"] != base.get("kind", over["kind"]):
        return over
    return base | {key: _merge_values(base.get(key), value) for key, value in over.items()}


def _construct(
    loader: _Loader,
    node: Any,
    path: KeyPath,
    places: dict[KeyPath, Place],
    problems: list[Problem],
    source: str,
) -> Any:
    if isinstance(node, yaml.SequenceNode):
        for index, item in enumerate(node.value):
            places[(*path, index)] = _place(source, item.start_mark)
        return [
            _construct(loader, item, (*path, index), places, problems, source)
            for index, item in enumerate(node.value)
        ]
    if not isinstance(node, yaml.MappingNode):
        return None if node is None else _scalar(loader, node, problems, source)
    value: dict[str, Any] = {}
    for key_node, value_node in node.value:
        place = _place(source, key_node.start_mark)
        if not isinstance(key_node, yaml.ScalarNode):
            problems.append(Problem(place, "a key must be a text, not a list or a mapping"))
            continue
        key = str(key_node.value)
        if key in value:
            first = places[(*path, key)].line
            problems.append(Problem(place, f"{key}: this key was already given in line {first}"))
            continue
        places[(*path, key)] = place
        value[key] = _construct(loader, value_node, (*path, key), places, problems, source)
    return value


def _scalar(loader: _Loader, node: Any, problems: list[Problem], source: str) -> Any:
    try:
        return loader.construct_object(node, deep=True)
    except (ValueError, KeyError, AttributeError):
        tag = node.tag.rpartition(":")[2]
        place = _place(source, node.start_mark)
        problems.append(Problem(place, f"{str(node.value)[:40]!r} is not a value of type {tag}"))
        return None


def _place(source: str, mark: Any) -> Place:
    return Place(source, mark.line + 1, mark.column + 1) if mark else Place(source, 1, 1)


def _said(error: yaml.MarkedYAMLError) -> str:
    context = f"{error.context}: " if error.context else ""
    return f"not valid YAML: {context}{error.problem}"
