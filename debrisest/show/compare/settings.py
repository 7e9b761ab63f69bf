"""What differs between the scenarios of two results, before any figure is compared."""

from collections.abc import Iterator
from typing import Any

from debrisest.results.status import flat
from debrisest.show.compare.sides import Comparison

_NOT_THERE = "not there"


def different_settings(found: Comparison) -> list[str]:
    """Return a line for each key that differs, with both values and the cases that it holds for."""
    cases: dict[str, list[str]] = {}
    seen = list(found.pairs())
    for case, mine, other in seen:
        for line in _differences(found, case, mine, other):
            cases.setdefault(line, []).append(case)
    every = len({case for case, *_ in seen})
    told = []
    for line, those in cases.items():
        names = list(dict.fromkeys(those))
        told.append(line if len(names) == every else f"{line} (case {', '.join(names)})")
    return [*told, *_versions(found)]


def _differences(found: Comparison, case: str, mine: str, other: str) -> Iterator[str]:
    one, two = found.first.scenario(case, mine), found.second.scenario(case, other)
    own = one.pop("estimators").get(mine, {}), two.pop("estimators").get(other, {})
    yield from _changes("", one, two)
    yield from _changes(f"estimators.{mine}." if mine == other else f"{mine} -> {other}: ", *own)


def _changes(prefix: str, one: dict[str, Any], two: dict[str, Any]) -> Iterator[str]:
    before, after = flat(one), flat(two)
    for key in before | after:
        if before.get(key) != after.get(key):
            was, is_now = (values.get(key, _NOT_THERE) for values in (before, after))
            yield f"{prefix}{key}: {was} -> {is_now}"


def _versions(found: Comparison) -> Iterator[str]:
    """Yield what differs in the versions that made the results."""
    if not found.within:
        for what in ("software", "commit"):
            one, two = (
                sorted({str(chunk.attributes.get(what)) for chunk in side.results.chunks})
                for side in (found.first, found.second)
            )
            if one != two:
                yield f"{what}: {' and '.join(one)} -> {' and '.join(two)}"
