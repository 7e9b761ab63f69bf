"""What is compared: an estimator's runs on two sides, and whether they can be paired."""

from collections.abc import Iterator, Sequence
from enum import StrEnum
from functools import cached_property, partial
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from debrisest.errors import UserError, allowed_names
from debrisest.results.chunk import Chunk
from debrisest.results.figured import AllRuns, figured
from debrisest.results.open import open_results
from debrisest.results.results import Results
from debrisest.results.runs import SIMULATED
from debrisest.scenario.schema import SIMULATED as OF_SIMULATION
from debrisest.scenario.table_keys import Tables
from debrisest.show.tables.figures import figures_of

_OF_DATA = (*(key for key in OF_SIMULATION if key != "runs"), "starts", "measured")


class Pairing(StrEnum):
    """What the runs of one number have in common on both sides."""

    DATA = "paired: the same data"
    DRAWS = "paired: the same draws of other data"
    NONE = "unpaired: other draws"


class Side:
    """The results of one folder, by case and estimator."""

    def __init__(self, folder: Path) -> None:
        self.results: Results = open_results(folder)
        self.asked: Tables | None = None
        """The tables whose figures are compared; by default its own."""
        self.told: dict[tuple[str, str], Chunk] = {}
        for chunk in self.results.chunks:
            case, stage, estimator = chunk.address[1:4]
            if stage in ("simulate", "assess"):
                first = self.told.setdefault((case, estimator or SIMULATED), chunk)
                if first.attributes["stage_key"] != chunk.attributes["stage_key"]:
                    raise UserError(
                        f"{chunk.path} and {first.path.name} are of different settings; "
                        "bring the folder up to date with a sweep first"
                    )

    @cached_property
    def tables(self) -> Tables:
        """Return how the results are scored."""
        chunk = next(iter(self.told.values()))
        return Tables.model_validate(yaml.safe_load(chunk.attributes["scenario"])["tables"])

    @cached_property
    def figured(self) -> AllRuns:
        """Return the figures of all runs that the tables show."""
        tables = self.asked or self.tables
        simulated = {n for t in tables.layout if t.stage == "simulate" for n in t.quantities}
        return figured(self.results, partial(figures_of, tables), simulated)

    @property
    def estimators(self) -> list[str]:
        """Return the names of the estimators that were assessed."""
        return list(dict.fromkeys(name for _, name in self.told if name != SIMULATED))

    def scenario(self, case: str, estimator: str) -> dict[str, Any]:
        """Return the resolved scenario of an estimator's results."""
        found: dict[str, Any] = yaml.safe_load(self.told[case, estimator].attributes["scenario"])
        return found


class Comparison(NamedTuple):
    """Two sides, and which estimator of the first stands against which of the second."""

    first: Side
    second: Side
    estimators: list[tuple[str, str]]

    @property
    def within(self) -> bool:
        """Return whether both sides are of one folder."""
        return self.first is self.second

    def pairs(self) -> Iterator[tuple[str, str, str]]:
        """Yield case, first and second estimator of what is there on both sides."""
        for case, estimator in self.first.told:
            for mine, other in self.estimators:
                if mine == estimator and (case, other) in self.second.told:
                    yield case, mine, other

    def pairing(self, case: str, mine: str, other: str) -> Pairing:
        """Return what the runs of a case have in common."""
        both = self.first.scenario(case, mine), self.second.scenario(case, other)
        one, two = ({key: each.get(key) for key in _OF_DATA} for each in both)
        if one == two:
            return Pairing.DATA
        same = one["seed"] is not None and one["seed"] == two["seed"]
        return Pairing.DRAWS if same else Pairing.NONE


def comparison(folders: Sequence[Path], estimators: Sequence[str]) -> Comparison:
    """Return what two folders, or two estimators of one folder, have to compare.

    One name restricts two folders to an estimator; two names set the first's against the second's.
    Raises UserError for names that are not there, and where there is nothing to compare.
    """
    sides = [Side(folder) for folder in folders]
    first, second = sides[0], sides[-1]
    second.asked = first.tables
    if len(folders) > 2 or (len(folders) == 1 and len(estimators) != 2) or len(estimators) > 2:
        raise UserError(
            "give two folders of results, or one folder and two estimators: "
            "debrisest compare A B; debrisest compare A --estimator X --estimator Y"
        )
    for side, name in zip((first, second), [*estimators, *estimators][-2:]):
        if name not in side.estimators:
            known = allowed_names(name, side.estimators)
            raise UserError(f"--estimator {name}: {side.results.folder} has none; {known}")
    both = [name for name in first.estimators if name in second.estimators]
    asked = [(estimators[0], estimators[-1])] if estimators else [(n, n) for n in both]
    asked += [] if estimators else [(SIMULATED, SIMULATED)]
    found = Comparison(first, second, asked)
    if not any(found.pairs()):
        raise UserError(
            f"{first.results.folder} has the cases {', '.join(first.results.cases)}, "
            f"{second.results.folder} has {', '.join(second.results.cases)}: "
            "nothing is there on both sides"
        )
    return found
