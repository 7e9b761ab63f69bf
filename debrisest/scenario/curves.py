"""Which cases differ in one number alone, of a grid or not: the points of a curve over it."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from debrisest.scenario.case import Case

FEWEST = 3
"""Points below which there is no curve to see."""
_TELL_NOTHING = ("title", "runs", "draws")


class Curve(NamedTuple):
    """The path of a key, and the values that it has in some cases, the smallest first."""

    key: str
    values: dict[str, float]


def curves(cases: Mapping[str, Case]) -> list[Curve]:
    """Return all sets of cases that are alike but for one number."""
    leaves = {name: dict(_leaves(case.document)) for name, case in cases.items()}
    every = dict.fromkeys(key for leaf in leaves.values() for key in leaf)
    varied = [key for key in every if len({repr(leaf.get(key)) for leaf in leaves.values()}) > 1]
    return [Curve(key, points) for key in varied for points in _alike(leaves, key, varied)]


def _alike(
    leaves: dict[str, dict[str, Any]], key: str, varied: list[str]
) -> Iterator[dict[str, float]]:
    """Yield the cases and values of each set that is alike in all other keys."""
    found: dict[str, dict[float, str]] = {}
    for name, leaf in leaves.items():
        value = leaf.get(key)
        if isinstance(value, int | float) and not isinstance(value, bool):
            others = repr([leaf.get(other) for other in varied if other != key])
            found.setdefault(others, {}).setdefault(float(value), name)
    for points in found.values():
        if len(points) >= FEWEST:
            yield {name: value for value, name in sorted(points.items())}


def _leaves(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, below in value.items():
            if path or key not in _TELL_NOTHING:
                yield from _leaves(below, f"{path}.{key}" if path else str(key))
    else:
        yield path, value
