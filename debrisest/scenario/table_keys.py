"""What a scenario file may say of its tables."""

from collections import Counter
from typing import Annotated, Literal, TypeVar

from pydantic import AfterValidator, Field, model_validator

from debrisest.assessment.statistics import STATISTICS
from debrisest.errors import allowed_names
from debrisest.roles import Keys, Positive
from debrisest.scenario.names import CaseName, Line, TableName
from debrisest.scenario.window import WindowText
from debrisest.vocabulary import VOCABULARY, possible_units


def _known_quantity(name: str) -> str:
    if name not in VOCABULARY or not VOCABULARY[name].table_unit:
        raise ValueError(f"no table can show {name!r}; {allowed_names(name, _quantities())}")
    return name


def _quantities() -> list[str]:
    return [name for name, entry in VOCABULARY.items() if entry.table_unit]


def _known_statistic(name: str) -> str:
    if name not in STATISTICS:
        raise ValueError(f"unknown statistic {name!r}; {allowed_names(name, STATISTICS)}")
    return name


QuantityName = Annotated[
    str,
    AfterValidator(_known_quantity),
    Field(json_schema_extra=lambda schema: schema.update(enum=_quantities())),
]
StatisticName = Annotated[
    str, AfterValidator(_known_statistic), Field(json_schema_extra={"enum": [*STATISTICS]})
]


def _distinct(names: list[str]) -> list[str]:
    for name, times in Counter(names).items():
        if times > 1:
            raise ValueError(f"{name!r} is there {times} times")
    return names


_Text = TypeVar("_Text")
Distinct = Annotated[
    list[_Text],
    Field(min_length=1, json_schema_extra={"uniqueItems": True}),
    AfterValidator(_distinct),
]
"""At least one, and none of them twice, which would count it as two."""


class Divergence(Keys):
    """A run has diverged if a quantity over a window, by default its RMS, is above a limit."""

    quantity: QuantityName
    """A quantity of the tables."""
    above: Positive
    """The limit, in the unit of the tables."""
    window: WindowText
    """A window."""
    statistic: StatisticName = "rms"
    """A statistic, of which the figure per run is used."""


class Table(Keys):
    """Cells: every quantity by every statistic and window, for each case and estimator.

    What was simulated has no estimator.
    """

    table: TableName
    """The paper's number, or a short word; several tables may share it."""
    title: Line
    """Its heading."""
    stage: Literal["simulate", "recover", "filter"]
    """Whose errors: those of the recovery or those of the filter; or figures of what was
    simulated."""
    quantities: Distinct[QuantityName]
    """Quantities."""
    statistics: Distinct[StatisticName]
    """Statistics."""
    windows: Distinct[WindowText]
    """Windows."""
    cases: list[str] | None = None
    """Cases and means that the table shows; none: all."""
    units: dict[QuantityName, str] = {}
    """Another unit than the quantity's own, such as `position: km`."""
    count_diverged: bool = False
    """Runs that diverged count as well, as far as they are finite."""

    @model_validator(mode="after")
    def _known_units(self) -> "Table":
        for name, unit in self.units.items():
            allowed = possible_units(name)
            if unit not in allowed:
                raise ValueError(
                    f"{name} cannot be shown in {unit!r}; {allowed_names(unit, allowed)}"
                )
        return self


class Tables(Keys):
    """How results are scored and laid out."""

    published: str | None = None
    """CSV of published values, relative to the scenario file."""
    scored_window: WindowText | None = None
    """Epochs by which a run's estimated principal axes are matched with the true ones; none: the
    last third."""
    diverged: list[Divergence] = []
    """Which runs count as diverged."""
    means: dict[CaseName, Annotated[list[str], AfterValidator(_distinct)]] = {}
    """Means over cases: a name that no case has, and its cases."""
    layout: list[Table] = []
    """The tables."""
