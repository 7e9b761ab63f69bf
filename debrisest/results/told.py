"""What the attributes of a checkpoint tell, and whether it can be so."""

import json
from collections.abc import Callable, Container, Mapping
from contextlib import suppress
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from debrisest.arrays import Data
from debrisest.vocabulary import VOCABULARY

_TYPES: dict[str, type] = {
    "first_run": int,
    "runs": int,
    "whole_runs": int,
    "failed_runs": int,
    "cpu_s": float,
    "seed": int,
    **dict.fromkeys(("case", "estimator", "stage", "stage_key", "scenario", "created"), str),
    **dict.fromkeys(("software", "commit", "imported_from"), str),
    **dict.fromkeys(("inputs", "plugins", "datasets"), dict),
}
"""Of each attribute; dict: a text (JSON) of one."""
_ALWAYS = ("stage", "created", "datasets")
_OF_STEPS = ("runs", "inputs", "scenario")
"""What a file has that some step made, which then has a stage_key."""


def forms(data: Data) -> str:
    """Return the type and the lengths of all datasets as the attribute ``datasets``."""
    return json.dumps({name: form(value) for name, value in data.items()})


@lru_cache
def axes_told(datasets: str) -> dict[str, int]:
    """Return how many axes each dataset has, of the attribute ``datasets``."""
    return {name: len(words.split()) - 1 for name, words in json.loads(datasets).items()}


def form(values: Any) -> str:
    """Return the type and the lengths of an array or dataset in words."""
    kind = "text" if values.dtype.kind in "OUS" else "number"
    return " ".join(map(str, (kind, *values.shape)))


def require_told(attributes: Mapping[str, Any]) -> None:
    """Raise ValueError for an attribute that is missing, or of a type that it cannot have."""
    for name in (*_ALWAYS, *_OF_STEPS * ("stage_key" in attributes)):
        if name not in attributes:
            raise ValueError(f"{name} is missing")
    for name in _TYPES.keys() & attributes.keys():
        value = attributes[name]
        found = _of_json(value) if _TYPES[name] is dict else value
        if type(found) is not _TYPES[name]:
            raise ValueError(f"{name} is {value!r}")
    runs, told = attributes.get("runs"), json.loads(attributes["datasets"])
    if runs is not None and (runs < 1 or told.get("run", f"number {runs}") != f"number {runs}"):
        raise ValueError("its runs are others than it says")


def _of_json(text: Any) -> Any:
    """Return what a text (JSON) tells, or nothing where there is none."""
    with suppress(ValueError, TypeError, RecursionError):
        return json.loads(text)
    return None


def require_as_told(
    attributes: Mapping[str, Any],
    found: Mapping[str, Any],
    names: Container[str],
    values: Callable[[Any], NDArray[Any]],
) -> None:
    """Raise ValueError unless of the named datasets just those are there that are told.

    ``values`` reads one of them, once it has the lengths that it should have.
    """
    told = json.loads(attributes["datasets"])
    wanted = {name: words for name, words in told.items() if name in names and name in VOCABULARY}
    if {name: form(dataset) for name, dataset in found.items()} != wanted:
        raise ValueError("its datasets are others than it says")
    if "run" in found and "runs" in attributes:
        count, first = attributes["runs"], attributes.get("first_run", 0)
        if not np.array_equal(values(found["run"]), first + np.arange(float(count))):
            raise ValueError("its runs are others than it says")
    if "time_s" in found and not np.all(np.diff(values(found["time_s"])) > 0):
        raise ValueError("its times do not ascend")
