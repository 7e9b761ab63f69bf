"""The cells of a scenario, kept beside its tables: made again where what they follow from changes.

They follow from files of results, which their digests tell, from the scenario's tables, the
published values, and the code. Whoever asks verifies the files; no time or size of one is trusted.
"""

import json
from collections.abc import Callable
from contextlib import suppress
from hashlib import sha256

from debrisest.files import content, put
from debrisest.fingerprint import fingerprint
from debrisest.results.results import Results
from debrisest.scenario.load import LoadedScenario
from debrisest.show.tables.cells import Row
from debrisest.show.tables.published import published_values

NAME = "cells.json"


def kept(scenario: LoadedScenario, results: Results, make: Callable[[], list[Row]]) -> list[Row]:
    """Return the rows that were made of the very same results, or make them and keep them."""
    if not results.chunks:
        return make()
    path, source = results.folder / NAME, _source(scenario, results)
    with suppress(OSError, ValueError):
        seal, rows = content(path).decode().split("\n", 1)
        if seal == _seal(source, rows):
            return list(json.loads(rows))
    made = make()
    text = json.dumps(made)
    with suppress(OSError):
        put(path, f"{_seal(source, text)}\n{text}".encode())
    return made


def _seal(source: str, rows: str) -> str:
    return sha256(f"{source}\n{rows}".encode()).hexdigest()


def _source(scenario: LoadedScenario, results: Results) -> str:
    """Return all that cells follow from, as a text."""
    files = [(*one.address, one.runs, one.digest) for one in results.chunks]
    plugins = {plugin.digest for case in scenario.cases.values() for plugin in case.plugins}
    common = scenario.common.model_dump(mode="json")
    told = [fingerprint(), sorted(plugins), common, list(scenario.cases), scenario.grid, files]
    published = [(*key, repr(value)) for key, value in published_values(scenario).items()]
    return json.dumps([*told, published], default=str)
