"""What speaks against a file of results: whether it serves what is wanted now, and if not, why."""

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from debrisest.errors import UserError
from debrisest.results.address import Address
from debrisest.results.results import Results
from debrisest.results.store import Checkpoint, Condition, fits


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A file that a plan wants, and what speaks against the one that is there."""

    address: Address
    path: Path
    runs: int
    whole_runs: int = 0
    """How many of them, the first ones, have their trajectories kept, if its stage has any."""
    inputs: dict[str, Any]
    key: str
    reason: str = ""
    """Why it has to be computed; empty where the file is up to date."""
    notice: str = ""
    """What the user should know about the file that is replaced."""

    @property
    def attributes(self) -> dict[str, Any]:
        """Return what the attributes of a file that serves say, but for the number of runs."""
        return self.address.attributes | {"stage_key": self.key}

    @property
    def name(self) -> str:
        """Return what this file is called in messages."""
        first = self.address.first_run
        return f"{self.address.name}, runs {first}-{first + self.runs - 1}"


def out_of_date(wanted: Wanted, found: Checkpoint, otherwise: str = "") -> tuple[str, str]:
    """Return why a file does not serve, and a notice where one is given up; empty if it serves.

    ``otherwise`` is a reason that lies outside of the file, and speaks against any that is whole.
    Raises UserError where something foreign has its name.
    """
    condition = found.condition
    if condition is Condition.FOREIGN:
        raise UserError(
            f"{wanted.path} is {condition.value}; move it away or choose another folder with --out"
        )
    if condition is Condition.MISSING:
        return "not there yet", ""
    if condition is Condition.WHOLE and not fits(found.attributes, wanted.address.attributes):
        condition = Condition.ANOTHER
    if condition is not Condition.WHOLE:
        told = f"{wanted.path} is {condition.value}: it is computed again"
        return f"its file is {condition.value}", told
    return otherwise or _outdated(wanted, found.attributes), ""


def up_to_date(results: Results, wanted: Iterable[Wanted], complete: bool = False) -> Results:
    """Return the results that are up to date; ``complete``: of stages with no file that is not."""
    files = list(wanted)
    _require_unchanged(results, files)
    gaps = {one.address[:4] for one in files if one.reason and complete}
    return results.limited(
        {one.address: one.runs for one in files if not one.reason and one.address[:4] not in gaps}
    )


def _require_unchanged(results: Results, wanted: Iterable[Wanted]) -> None:
    """Raise UserError for a file that served when it was planned, and is another one now."""
    there = {chunk.address: chunk.attributes for chunk in results.chunks}
    for one in wanted:
        if not one.reason and not fits(there.get(one.address, {}), one.attributes):
            raise UserError(f"{one.path} was replaced while it was to be read; try again")


def _outdated(wanted: Wanted, attributes: dict[str, Any]) -> str:
    if attributes.get("stage_key") != wanted.key:
        return difference(json.loads(attributes["inputs"]), wanted.inputs)
    if attributes["runs"] < wanted.runs:
        return f"holds {attributes['runs']} runs, {wanted.runs} are wanted"
    if (whole := attributes.get("whole_runs", wanted.runs)) < wanted.whole_runs:
        return f"keeps the trajectories of {whole} runs, those of {wanted.whole_runs} are wanted"
    return ""


def difference(before: dict[str, Any], now: dict[str, Any]) -> str:
    """Return the first keys whose values differ, with both values."""
    was, now_is = flat(before), flat(now)
    changed = [key for key in was | now_is if was.get(key) != now_is.get(key)]
    if not changed and list(was) != list(now_is):
        return "the order of its parts changed"
    if not changed:
        return "an earlier stage was computed anew"
    told = [_change(key, was.get(key), now_is.get(key)) for key in changed[:3]]
    return "; ".join(told) + ("; ..." if len(changed) > 3 else "")


def _change(key: str, was: Any, now_is: Any) -> str:
    part, plugin, name = key.partition(".plug-in ")
    return f"{part}: plug-in {name} changed" if plugin else f"{key} was {was}, is {now_is}"


def flat(value: Any, prefix: str = "") -> dict[str, Any]:
    """Return the leaves of nested plain data by their key paths."""
    if isinstance(value, dict):
        items = value.items()
    elif isinstance(value, list):
        items = {str(index): item for index, item in enumerate(value)}.items()
    else:
        return {prefix: value}
    return {
        path: leaf
        for key, item in items
        for path, leaf in flat(item, f"{prefix}.{key}" if prefix else str(key)).items()
    }
