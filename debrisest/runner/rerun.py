"""Run again what a file of results says of itself, and compare."""

import json
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from debrisest.arrays import Data
from debrisest.errors import UserError
from debrisest.plugins.load import Plugin
from debrisest.results import store
from debrisest.results.address import Address
from debrisest.results.status import out_of_date
from debrisest.runner.compute import compute
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.step import Step
from debrisest.scenario.load import load_scenario

_NEEDED = ("scenario", "first_run", "runs", "estimator", "plugins")


class Rerun(NamedTuple):
    """What a file holds, and how it differs from what is computed now."""

    name: str
    datasets: int
    since: str
    """What of its inputs, or of the code, is another since; empty where nothing is."""
    differing: list[str]
    """A sentence for each dataset whose bytes are not the same."""


def stored_scenario(path: Path) -> str:
    """Return the scenario file (YAML) that a file of results stores, or raise UserError."""
    return str(_attributes(path)["scenario"])


def rerun(path: Path, plugins: tuple[Plugin, ...] = ()) -> Rerun:
    """Compute what a file holds, and all that it needs before it, from its scenario alone.

    The results that lie beside it are neither read nor changed. Raises UserError for a file that
    is not whole, or whose scenario or plug-ins cannot be used any more.
    """
    attributes = _attributes(path)
    with tempfile.TemporaryDirectory() as folder:
        steps = _steps(path, attributes, Path(folder), plugins)
        for step in steps:
            compute([step])
        since, _ = out_of_date(steps[-1], store.inspect(path))
        before, now = store.read(path), store.read(steps[-1].path)
    return Rerun(_name(path, steps[-1]), len(now), since, list(_differences(before, now)))


def _attributes(path: Path) -> dict[str, Any]:
    condition, attributes, _ = store.inspect(path)
    if condition is not store.Condition.WHOLE:
        raise UserError(f"{path}: the file is {condition.value}; give a file of results (.h5)")
    if lacking := [name for name in _NEEDED if name not in attributes]:
        raise UserError(f"{path}: no step of a sweep made this file: it lacks {lacking[0]}")
    return attributes


def _steps(
    path: Path, attributes: dict[str, Any], folder: Path, plugins: tuple[Plugin, ...]
) -> list[Step]:
    """Return the steps that lead to a file, itself the last."""
    config = folder / "stored.yaml"
    config.write_text(attributes["scenario"], encoding="utf-8")
    try:
        scenario = load_scenario(config, plugins=plugins)
    except UserError as error:
        told = [problem.replace(str(config), f"{path}, scenario") for problem in error.problems]
        raise UserError([*told, *_missing(path, attributes, plugins)]) from None
    first, runs, estimator = (attributes[key] for key in ("first_run", "runs", "estimator"))
    chosen = [estimator] if estimator else None
    selection = Selection(first + runs, None, chosen, attributes["stage"])
    steps = plan(scenario, folder, selection)
    of = (attributes["stage"], estimator, first)
    own = next(step for step in steps if step.address[2:] == of)
    return [step for step in steps if step.path in {own.path, *(up.path for up in own.upstream)}]


def _name(path: Path, step: Step) -> str:
    """Return what a file is called in messages: its folder may have a name no scenario has."""
    there = Address.of(path)
    scenario = there.scenario if there else step.address.scenario
    return replace(step, address=step.address._replace(scenario=scenario)).name


def _missing(path: Path, attributes: dict[str, Any], plugins: tuple[Plugin, ...]) -> Iterator[str]:
    """Yield the plug-ins that a file was made with and that are not given as they were."""
    given = {plugin.digest for plugin in plugins}
    for name, digest in json.loads(attributes["plugins"]).items():
        if digest not in given:
            yield f"{path} was made with the plug-in {name}; give it by --plugin"


def _differences(before: Data, now: Data) -> Iterator[str]:
    for name in sorted(before.keys() | now.keys()):
        was, is_now = before.get(name), now.get(name)
        if was is None or is_now is None:
            yield f"{name}: only {'stored' if is_now is None else 'computed now'}"
        elif was.shape != is_now.shape:
            yield f"{name}: stored {was.shape}, computed now {is_now.shape}"
        elif was.tobytes() != is_now.tobytes():
            yield f"{name}: {_how_far(was, is_now)}"


def _how_far(was: Any, now: Any) -> str:
    both_nan = np.isnan(was) & np.isnan(now) if was.dtype.kind == "f" else False
    other = ~((was == now) | both_nan)
    told = f"{np.count_nonzero(other)} of {other.size} values differ"
    if was.dtype.kind != "f":
        return told
    with np.errstate(invalid="ignore"):
        return f"{told}, by {np.nanmax(np.abs(was - now), initial=0.0):.3g} at most"
