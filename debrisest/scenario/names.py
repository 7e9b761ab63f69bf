"""Names and texts that every file, table, figure and terminal can carry."""

import re
from collections.abc import Callable, Hashable, Iterable, Iterator
from pathlib import Path, PureWindowsPath
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from debrisest.draws import case_key
from debrisest.errors import UserError
from debrisest.files import alike

MOST_LETTERS = 100
MOST_LETTERS_OF_A_PART = 50
"""Together with a case's name and a host's it must be a file's name, of 255 bytes at most."""
UNNAMED = re.compile(r"[^A-Za-z0-9_.+=,-]")
"""What no name of a case or variant has."""
_TAKEN = ("tables.", "report.", "estimates.")
_FORMULA = ("=", "+", "-", "@")
VARIANT = "@"
"""Stands between the name of a scenario and that of its variant."""


def _name(signs: str, most: int, told: str) -> Any:
    """Return the type of names that begin with a letter, digit or underscore."""
    pattern = f"[A-Za-z0-9_][A-Za-z0-9_{re.escape(signs)}]*"

    def known(name: str) -> str:
        if len(name) > most:
            raise ValueError(f"a name has at most {most} letters, this one {len(name)}")
        if not re.fullmatch(pattern, name):
            raise ValueError(f"a name has letters, digits, _ and {told}, not {name!r}")
        return name

    shown: Any = {"pattern": f"^{pattern}$", "maxLength": most}
    return Annotated[str, AfterValidator(known), Field(json_schema_extra=shown)]


CaseName = _name(".+=,-", MOST_LETTERS, ". + = , - (the first no sign)")
PartName = _name("+,-", MOST_LETTERS_OF_A_PART, "+ , - (the first no sign; a dot separates keys)")
TableName = _name(" .+,()/-", MOST_LETTERS, "blanks and . + , ( ) / - (the first no sign)")
Line = Annotated[str, AfterValidator(lambda text: " ".join(text.split()))]
"""A text of one line: what stands on several is put on one."""


def check_scenario_name(path: Path) -> None:
    """Raise UserError where a file's stem cannot be the name of a folder of results."""
    name = path.stem
    odd = name != name.strip(". ") or name.startswith(_FORMULA) or not name.isprintable()
    if odd or PureWindowsPath(name).is_reserved():
        raise UserError(
            f"{path}: the scenario would be called {name!r}, after its file; a name neither begins "
            f"with one of {' '.join(_FORMULA)} nor with a dot or a blank, nor ends with these, "
            "has no control characters, and is no device of Windows; rename the file"
        )
    if VARIANT in name:
        raise UserError(
            f"{path}: a scenario's name has no {VARIANT}, which stands before the name of a "
            "variant (--variant), in whose folder its results would lie; rename the file"
        )
    if len(name.encode()) > MOST_LETTERS:
        raise UserError(f"{path}: a scenario's name has at most {MOST_LETTERS} letters; rename it")


def check_path(path: Path) -> None:
    """Raise UserError for a path, from the root on, that no file of results could name."""
    try:
        str(path.absolute()).encode()
    except UnicodeEncodeError:
        said = f"{path}: this path is no text in UTF-8, and results name it"
        raise UserError(f"{said}; rename the file or folder that is not") from None


def case_name_problems(names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the cases that cannot have their names, each with the reason."""
    names = list(names)
    for name in names:
        if name.casefold() in ("plots", "cells.json") or name.casefold().startswith(_TAKEN):
            yield name, "this name is taken by a file of results; choose another"
        if name.endswith(".") or PureWindowsPath(name).is_reserved():
            yield name, "Windows can have no folder of this name; choose another"
        if len(name) > MOST_LETTERS:
            said = f"the grid names this case with {len(name)} letters, at most {MOST_LETTERS} are"
            yield name, f"{said} possible: {name[:40]}...; vary fewer keys, or by cases"
    yield from same_on_disk(names)
    yield from same_draws(names)


def same_draws(names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the names to which the same draws would be bound as to an earlier one."""
    same = "the draws of both would be the same (their CRC-32 is); choose another name"
    return _not_told_apart(names, case_key, same)


def same_on_disk(names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the names that some disk takes for an earlier one."""
    same = "a disk that ignores case would mix their files; choose another name"
    return _not_told_apart(names, alike, same)


def _not_told_apart(
    names: Iterable[str], key: Callable[[str], Hashable], why: str
) -> Iterator[tuple[str, str]]:
    first: dict[Hashable, str] = {}
    for name in names:
        other = first.setdefault(key(name), name)
        if other != name:
            yield name, f"beside {other!r}: {why}"
