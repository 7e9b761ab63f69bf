"""The names of a table's columns: needed, known, or one of the usual mistakes."""

import difflib
import re
from dataclasses import dataclass, field

from debrisest.tracks.report import Report

_UNITS = {
    *("s", "ms", "us", "ns", "min", "h"),
    *("m", "mm", "cm", "km", "in", "ft"),
    "px",
    *("deg", "rad", "mrad"),
}
_ORDER = {"w": "q0", "s": "q0", "x": "q1", "y": "q2", "z": "q3"}


@dataclass(frozen=True)
class Layout:
    """Columns of a kind of table: needed and optional ones, texts, and those with gaps."""

    needed: tuple[str, ...]
    optional: tuple[str, ...] = ()
    texts: frozenset[str] = field(default_factory=frozenset)
    gaps: frozenset[str] = field(default_factory=frozenset)

    @property
    def known(self) -> tuple[str, ...]:
        """All columns that such a table may have."""
        return self.needed + self.optional


def check_names(names: tuple[str, ...], line: int, layout: Layout, report: Report) -> None:
    """Report unknown, double and missing columns of a header; at once, since rows need them."""
    known, seen = layout.known, set[str]()
    for name in names:
        if name in seen:
            report.add(line, f"column {name!r} is there twice; which one is meant?")
        elif name not in known:
            report.add(line, _unknown(name, known))
        seen.add(name)
    for name in layout.needed:
        if name not in names:
            report.add(line, f"column {name} is missing; the header has {', '.join(names)[:200]}")
    report.check()


def together(
    names: tuple[str, ...], group: tuple[str, ...], line: int, report: Report, of: str = ""
) -> bool:
    """Return whether a group of columns is there; part of a group is a problem."""
    there = [name for name in group if name in names]
    if there and len(there) < len(group):
        missing = ", ".join(name for name in group if name not in there)
        report.add(line, f"{', '.join(there)} without {missing}: give all of them, or none", of)
    return len(there) == len(group)


def _unknown(name: str, known: tuple[str, ...]) -> str:
    if not name:
        return "a column has no name; name it, or remove it and its delimiter"
    if re.fullmatch(r"[-+0-9.eE]+|nan", name):
        return f"{name} where a column's name should be: the header is missing, or commented out"
    if scalar := re.fullmatch(r"q_?([wsxyz])", name):
        wanted = f"here {_ORDER[scalar[1]]}"
        return f"unknown column {name}; quaternions are q0 (the scalar), q1, q2, q3: {wanted}"
    if sibling := _other_unit(name, known):
        return f"unknown column {name}: the unit is in the name; convert the values to {sibling}"
    close = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    hint = f"did you mean {close[0]}?" if close else f"allowed are {', '.join(known)[:300]}"
    return f"unknown column {name[:60]!r}; {hint}"


def _other_unit(name: str, known: tuple[str, ...]) -> str | None:
    """Known column of the same quantity in another unit, or whose unit was left out."""
    stem, _, unit = name.rpartition("_")
    stems = [stem, name] if unit in _UNITS else [name]
    for wanted in known:
        base, _, ends = wanted.rpartition("_")
        if base and base in stems and ends in _UNITS:
            return wanted
    return None
