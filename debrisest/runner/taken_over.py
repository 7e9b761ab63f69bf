"""Files that another variant of a scenario has already: the same key means the same bytes."""

import os
import re
import shutil
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from debrisest.files import replacing
from debrisest.results import store
from debrisest.results.status import Wanted, out_of_date
from debrisest.runner.step import Step
from debrisest.scenario.names import VARIANT

_TABLES = re.compile(r"^tables:.*?(?=^\w|\Z)", re.M | re.S)


def variants_beside(out: Path, name: str) -> list[str]:
    """Return the other folders of results of the same scenario, its plain one first."""
    stem = name.partition(VARIANT)[0]
    folders = (path.name for path in out.iterdir()) if out.is_dir() else ()
    return sorted(one for one in folders if one.partition(VARIANT)[0] == stem and one != name)


def same_file(
    wanted: Wanted, out: Path, folders: Iterable[str], depth: store.Depth, scenario: str
) -> Path | None:
    """Return the file of another folder that is what is wanted, if there is one.

    Errors are taken over with the tables only that they were scored for, since a comparison reads
    these from their file; ``scenario`` is the resolved one.
    """
    for folder in folders:
        path = wanted.address._replace(scenario=folder).path(out)
        found = store.inspect(path, depth)
        if found.condition is store.Condition.WHOLE and not out_of_date(wanted, found)[0]:
            told = str(found.attributes["scenario"])
            if wanted.address.stage != "assess" or _tables(told) == _tables(scenario):
                return path
    return None


def _tables(scenario: str) -> str:
    found = _TABLES.search(scenario)
    return found[0] if found else ""


def take_over(steps: Iterable[Step]) -> Iterator[Step]:
    """Link the files that another folder has, whole or not at all; yield what is left to do."""
    for step in steps:
        if step.same is None:
            yield step
            continue
        with replacing(step.path) as temporary:
            _link(step.same, temporary)
        store.require(step.path, step.attributes | {"runs": step.runs})
        yield replace(step, reason="", same=None)


def _link(source: Path, target: Path) -> None:
    """Make ``target`` the same file as ``source``, or a copy where the disk has no links."""
    target.unlink()
    with suppress(OSError):
        os.link(source, target)
        return
    shutil.copyfile(source, target)
