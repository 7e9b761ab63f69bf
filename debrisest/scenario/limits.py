"""How large and how small numbers can be: beyond it they are slips of the pen.

Within these limits the squares and cubes that formulas take of them are finite and not zero.
"""

from collections.abc import Iterator
from math import inf
from typing import Any

from debrisest.scenario.document import KeyPath

_LARGEST = {
    "_km": 1e9,
    "_m": 1e12,
    "_m_s": 1e7,
    "_deg_s": 1e4,
    "_rad_s": 1e3,
    "_deg": 1e6,
    "_px": 1e7,
    "_px_s": 1e7,
    "_kg": 1e12,
    "_s": inf,
    "2": inf,
    "_m_s2": 1e6,
    "_kg_m2": 1e15,
}
"""By the end of a key, its unit; the longest end that fits.

Times are checked against each other; a variance that is too large gives an estimate that diverged.
"""
LARGEST, SMALLEST = 1e19, 1e-30
"""Of every other number that is not zero, whatever its sign; the largest seed is below it."""


def extreme_numbers(value: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, str]]:
    """Yield the numbers of plain data that no experiment has, each with what is possible."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from extreme_numbers(inner, (*path, key))
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from extreme_numbers(inner, (*path, index))
    elif isinstance(value, int | float) and not isinstance(value, bool) and abs(value) != inf:
        found = f"whatever the sign (found {str(value)[:25]})"
        if abs(value) > (most := _largest(path)):
            yield path, f"at most {most:g} is possible here, {found}"
        elif 0 < abs(value) < SMALLEST:
            yield path, f"at least {SMALLEST:g} is possible here, or zero, {found}"


def _largest(path: KeyPath) -> float:
    """Return the limit of a value, by the name that stands nearest to it."""
    key = next((str(name) for name in reversed(path) if isinstance(name, str)), "")
    unit = max((end for end in _LARGEST if key.endswith(end)), key=len, default="")
    return _LARGEST.get(unit, LARGEST)
