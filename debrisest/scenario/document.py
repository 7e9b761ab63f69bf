"""A YAML file as plain data in which the place of every key is known.

Stricter than YAML 1.1: duplicate keys are problems, ``1e-6`` is a number, only ``true`` and
``false`` are booleans, keys are text, and dates and base-60 numbers do not exist.
"""

import re
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import yaml

from debrisest.errors import UNCARRIED

KeyPath = tuple[str | int, ...]
MOST_VALUES = 300_000
_LARGE = 100_000
"""Characters of a text from which on it is read by the quick loader."""


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
        return f"{self.place}: {self.message}".replace("\n", "\\n")


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


class _QuickLoader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """Written in C, where that is there: ten times as fast, but it says less of what is wrong."""

    yaml_implicit_resolvers: dict[Any, Any] = {}


class _Dumper(getattr(yaml, "CSafeDumper", yaml.SafeDumper)):  # type: ignore[misc]
    """Quotes each text that would be read as something else."""


for _tag, _pattern, _first in (
    ("bool", r"true|false", "tf"),
    ("null", r"null|~|", ["n", "~", ""]),
    ("int", r"[-+]?(0|[1-9][0-9]*)", "-+0123456789"),
    ("float", r"[-+]?([0-9]+\.[0-9]*|\.[0-9]+|[0-9]+)([eE][-+]?[0-9]+)?", "-+.0123456789"),
):
    for _either in (_Loader, _QuickLoader, _Dumper):
        _either.add_implicit_resolver(
            f"tag:yaml.org,2002:{_tag}", re.compile(f"^(?:{_pattern})$"), list(_first)
        )


def text_of(value: dict[str, Any]) -> str:
    """Return plain data as the YAML text of which ``parse`` makes them again."""
    return yaml.dump(value, Dumper=_Dumper, sort_keys=False, allow_unicode=True)


def parse(text: str, source: str) -> tuple[Document, list[Problem]]:
    """Parse YAML text whose top level is a mapping; ``source`` names it in messages."""
    start = Place(source, 1, 1)
    places: dict[KeyPath, Place] = {(): start}
    try:
        loader, node = _composed(text)
        reader = _Reader(loader, source, places)
        value = reader.value(node, ())
    except yaml.MarkedYAMLError as error:
        return Document({}, places), [Problem(_place(source, error.problem_mark), _said(error))]
    except RecursionError:
        return Document({}, places), [Problem(start, "not valid YAML: nested too deeply")]
    except yaml.reader.ReaderError as error:
        lines = text[: error.position].split("\n")
        place = Place(source, len(lines), len(lines[-1]) + 1)
        said = f"not a YAML text: it has the character U+{int(error.character):04X}; leave it out"
        return Document({}, places), [Problem(place, said)]
    except (yaml.YAMLError, ValueError) as error:
        return Document({}, places), [Problem(start, f"not a YAML text: {error}".split("\n")[0])]
    if not isinstance(value, dict):
        found = "the file is empty" if value is None else f"found {value!r}"[:60]
        message = f"expected a mapping of keys (title, seed, target, ...), {found}"
        return Document({}, places), [*reader.problems, Problem(start, message)]
    return Document(value, places), reader.problems


def _composed(text: str) -> tuple[Any, Any]:
    """Return the loader of a text and its node; a large text that has mistakes is read twice."""
    if len(text) > _LARGE and "\t" not in text:
        with suppress(yaml.YAMLError):
            quick = _QuickLoader(text)
            return quick, quick.get_single_node()
    loader = _Loader(text)
    return loader, loader.get_single_node()


Required = Callable[[str], Collection[str]]
"""The keys that a kind cannot do without."""


def merge(base: Document, over: Document, required: Required = lambda kind: ()) -> Document:
    """Return ``base`` with ``over`` laid on it: mappings merge key by key, the rest is replaced.

    A mapping of another ``kind`` replaces the base's, since the keys of a kind are its own, but for
    those that are ``required`` and not given again.
    """
    places = {path: place for path, place in over.places.items() if path}
    return Document(merge_values(base.value, over.value, required), base.places | places)


def sub_documents(document: Document, key: str) -> dict[str, Document]:
    """Return the mappings below a key as documents of their own, by name, keeping the places."""
    places: dict[str, dict[KeyPath, Place]] = {}
    for path, place in document.places.items():
        if len(path) > 1 and path[0] == key:
            places.setdefault(str(path[1]), {})[path[2:]] = place
    return {
        name: Document(value if isinstance(value, dict) else {}, places.get(name, {}))
        for name, value in document.value[key].items()
    }


def merge_values(base: Any, over: Any, required: Required = lambda kind: ()) -> Any:
    """Return plain data with others laid on them, as ``merge`` does."""
    if not (isinstance(base, dict) and isinstance(over, dict)):
        return over
    if "kind" in over and over["kind"] != base.get("kind", over["kind"]):
        return {key: base[key] for key in required(str(over["kind"])) if key in base} | over
    return base | {key: merge_values(base.get(key), value, required) for key, value in over.items()}


@dataclass
class _Reader:
    """Makes plain data of YAML nodes, noting the place of every key and what is wrong."""

    loader: Any
    source: str
    places: dict[KeyPath, Place]
    problems: list[Problem] = field(default_factory=list)
    read: int = 0

    def value(self, node: Any, path: KeyPath) -> Any:
        """Return the value of a node; raise ValueError where aliases make it far too large."""
        self.read += 1
        if self.read > MOST_VALUES:
            raise ValueError(
                f"more than {MOST_VALUES} values, aliases (*name) written out; such a file is "
                "a mistake, or larger than a scenario can be"
            )
        if isinstance(node, yaml.MappingNode):
            return self._mapping(node, path)
        if not isinstance(node, yaml.SequenceNode):
            return None if node is None else self._scalar(node)
        for index, item in enumerate(node.value):
            self.places[(*path, index)] = _place(self.source, item.start_mark)
        return [self.value(item, (*path, index)) for index, item in enumerate(node.value)]

    def _mapping(self, node: Any, path: KeyPath) -> dict[str, Any]:
        value: dict[str, Any] = {}
        for key_node, value_node in node.value:
            place = _place(self.source, key_node.start_mark)
            if not isinstance(key_node, yaml.ScalarNode):
                message = "a key must be a text, not a list or a mapping"
                self.problems.append(Problem(place, message))
                continue
            key = self._carried(str(key_node.value), place)
            if key in value:
                first = self.places[(*path, key)].line
                message = f"{key}: this key was already given in line {first}"
                self.problems.append(Problem(place, message))
                continue
            self.places[(*path, key)] = place
            value[key] = self.value(value_node, (*path, key))
        return value

    def _scalar(self, node: Any) -> Any:
        place = _place(self.source, node.start_mark)
        try:
            value = self.loader.construct_object(node, deep=True)
        except (ValueError, KeyError, AttributeError):
            tag = node.tag.rpartition(":")[2]
            message = f"{str(node.value)[:40]!r} is not a value of type {tag}"
            self.problems.append(Problem(place, message))
            return None
        return self._carried(value, place) if isinstance(value, str) else value

    def _carried(self, text: str, place: Place) -> str:
        """Return a text without the characters that nothing can carry, each a problem."""
        for code in dict.fromkeys(map(ord, UNCARRIED.findall(text))):
            message = f"{text[:40]!r} has the character U+{code:04X}, which no text can carry; "
            self.problems.append(Problem(place, message + "leave it out"))
        return UNCARRIED.sub("", text)


def _place(source: str, mark: Any) -> Place:
    return Place(source, mark.line + 1, mark.column + 1) if mark else Place(source, 1, 1)


def _said(error: yaml.MarkedYAMLError) -> str:
    context = f"{error.context}: " if error.context else ""
    return f"not valid YAML: {context}{error.problem}"


def nested(path: tuple[str, ...], value: Any, place: Place) -> Document:
    """Return a document that has one value, at a key path that was written at a place."""
    places: dict[KeyPath, Place] = {path[: depth + 1]: place for depth in range(len(path))}
    for name in reversed(path):
        value = {name: value}
    return Document(value, places)
