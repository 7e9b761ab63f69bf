"""What the results of a scenario with settings laid on it are called."""

import json
from collections.abc import Sequence
from typing import Any
from zlib import crc32

from pydantic import TypeAdapter, ValidationError

from debrisest.errors import UserError
from debrisest.scenario.document import parse
from debrisest.scenario.names import MOST_LETTERS, UNNAMED, CaseName

_OF_HASH = 8


def variant_called(name: str | None, settings: Sequence[str]) -> str:
    """Return the name of a variant: as it is called, or else after its settings.

    Raises UserError for a name that no folder should have.
    """
    if name is None:
        return variant_of(settings)
    try:
        TypeAdapter(CaseName).validate_python(name)
    except ValidationError as error:
        raise UserError(f"--variant {name}: {error.errors()[0]['ctx']['error']}") from None
    return name


def variant_of(settings: Sequence[str]) -> str:
    """Return the name of the variant that settings ``key.path=value`` make; empty without any.

    It has the keys in full, so that it stays the same whatever else a file gets:
    ``seed=2,sensors.points.noise_m=0.02``. Their order matters only where one key lies inside
    another. What a name cannot tell, or what is too long for one, ends in a hash of it all.
    """
    given = _in_order(settings)
    told = ",".join(f"{key}={_words(value)}" for key, value in given.items())
    name = UNNAMED.sub("", told)
    sure = all(_is_sure(value) for value in given.values()) and not name.endswith(".")
    if sure and name == told and len(name) <= MOST_LETTERS:
        return name
    return f"{name[: MOST_LETTERS - 1 - _OF_HASH]}-{crc32(json.dumps(given).encode()):08x}"


def _in_order(settings: Sequence[str]) -> dict[str, Any]:
    """Return the values that hold, by their keys, sorted where their order does not matter."""
    given: dict[str, Any] = {}
    for text in settings:
        key, _, value = text.partition("=")
        given.pop(key, None)
        given[key] = _read(value)
    if any(key.startswith(f"{above}.") for above in given for key in given):
        return given
    return dict(sorted(given.items()))


def _read(text: str) -> Any:
    return parse(f"value: {text}", "--set")[0].value.get("value")


def _words(value: Any) -> str:
    if isinstance(value, dict):
        return ",".join(f"{key}={_words(one)}" for key, one in value.items())
    if isinstance(value, list):
        return ",".join(map(_words, value))
    return value if isinstance(value, str) else json.dumps(value)


def _is_sure(value: Any) -> bool:
    """Whether no other value has the same words."""
    flat = value if isinstance(value, list) and len(value) > 1 else [value]
    return not any(
        isinstance(one, dict | list) or "," in _words(one) or _read(_words(one)) != one
        for one in flat
    )
