"""What a scenario file may hold. The kinds come from the catalog."""

from collections import Counter
from collections.abc import Sequence
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any, Literal, TypeVar

from pydantic import (
    AfterValidator,
    Field,
    ValidationInfo,
    create_model,
    field_validator,
    model_validator,
)

from debrisest.assessment.statistics import STATISTICS
from debrisest.catalog import CATALOG, kind_of
from debrisest.clock import Clock
from debrisest.errors import allowed_names
from debrisest.roles import (
    FilterPart,
    Keys,
    Part,
    Positive,
    ProblemPart,
    RecoveryPart,
    SimulationPart,
    SourcePart,
    StartPart,
    Window,
)
from debrisest.scenario.names import CaseName, Line, PartName, TableName
from debrisest.scenario.window import WindowText, window_of
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


class Estimator(Keys):
    """Recovery, start and filter, as far as an estimator has them."""

    recovery: RecoveryPart | None = None
    """Makes a signal over all epochs from measurements of single epochs."""
    problem: ProblemPart | None = None
    """What is estimated, from what, by which model."""
    start: StartPart | None = None
    """What is known before the first measurement."""
    filter: FilterPart | None = None
    """The algorithm."""
    cases: list[str] | None = None
    """Cases in which the estimator is used; none: all."""
    bound: str = "bound"
    """Estimator whose figures stand in the column `bound` of the tables; without that estimator it
    is empty."""

    @model_validator(mode="after")
    def _complete(self) -> "Estimator":
        given = [part is not None for part in (self.problem, self.start, self.filter)]
        if self.filter is not None and self.filter.makes_start:
            if self.start is not None:
                raise ValueError("this filter makes its own start; leave start out")
            given.remove(False)
        if any(given) and not all(given):
            raise ValueError("a filter needs all three of: problem, start, filter")
        if not any(given) and self.recovery is None:
            raise ValueError("an estimator needs a recovery or a filter")
        return self


MOST_RUNS = 1_000_000
TOLD_BY_DATA = ("seed", "runs", "duration_s")
"""Keys of a simulation that measured data tell."""
SIMULATED = (*TOLD_BY_DATA, "step_s", "target", "orbit", "motion", "observers", "sensors")
"""Keys in whose place `measured` stands."""


class Scenario(Keys):
    """One case of a scenario, everything resolved."""

    title: Line
    """Stands above the tables."""
    source: Line = ""
    """Where the experiment comes from, such as a paper."""
    seed: Annotated[int, Field(ge=0, lt=2**63)]
    """All randomness follows from it."""
    draws: CaseName | None = None
    """What draws are bound to, beside the seed; default: the case's own name. Cases of one name
    share theirs."""
    runs: Annotated[int, Field(ge=1, le=MOST_RUNS)]
    """Monte Carlo runs per case; `--runs N` overrides it."""
    keep: Annotated[int, Field(ge=1)] | Literal["all"] = 1
    """Runs whose trajectories are kept, the first ones, or `all`; `--keep` overrides it."""
    duration_s: Positive
    """Length; a whole number of steps, 2 to 10 million. Measured data tell it."""
    step_s: Positive | None = None
    """Time between epochs, which a simulation needs; the first is at 0, the end is not an epoch."""
    measured: SourcePart | None = None
    """Files in the place of the simulation."""
    target: SimulationPart | None = None
    """The body; a debris without extent has none."""
    orbit: SimulationPart | None = None
    """The target's orbit, with `seen_from_leader` the observer's; many parts need it."""
    motion: SimulationPart | None = None
    """How the body rotates, if it does."""
    observers: dict[str, SimulationPart] = {}
    """How the chaser moves, or satellites that observe."""
    sensors: dict[str, SimulationPart] = {}
    """What is measured, and what estimators are told of it; a simulation needs it."""
    starts: dict[str, SimulationPart] = {}
    """What is known at first, the same for all estimators."""
    estimators: dict[PartName, Estimator]
    """What is compared; the same in all cases."""
    tables: Tables = Tables()
    """How results are scored and laid out."""

    @property
    def clock(self) -> Clock:
        """Return the epochs of a simulation."""
        return Clock.regular(self.duration_s, self.step_s or self.duration_s)

    @property
    def whole_runs(self) -> int:
        """Return how many runs keep their trajectories."""
        return MOST_RUNS if self.keep == "all" else self.keep

    @property
    def simulation(self) -> dict[str, SimulationPart]:
        """Return the parts of the simulation in the order in which data passes through them."""
        alone = {"target": self.target, "orbit": self.orbit, "motion": self.motion}
        parts = {name: part for name, part in alone.items() if part is not None}
        named = {"observers": self.observers, "sensors": self.sensors, "starts": self.starts}
        return parts | {
            f"{role}.{name}": part for role, each in named.items() for name, part in each.items()
        }

    @property
    def frames(self) -> dict[str, str]:
        """Return the axes and origin of simulated datasets whose name does not tell them."""
        parts = self.simulation.values()
        return {name: told for part in parts for name, told in part.frames.items()}

    @property
    def libraries(self) -> set[str]:
        """Return the modules that its parts need beside the core's."""
        estimating = (
            part for one in self.estimators.values() for part in (one.recovery, one.filter)
        )
        parts = (*self.simulation.values(), self.measured, *estimating)
        return {name for part in parts if part is not None for name in part.libraries}

    @property
    def scored(self) -> Window:
        """Return the window in which principal axes are relabeled: by default the last third."""
        if self.tables.scored_window is None:
            return (self.duration_s * 2 / 3, self.duration_s)
        return window_of(self.tables.scored_window, self.duration_s)


class Measured(Keys):
    """The key of a scenario file that says where measured data come from."""

    measured: SourcePart
    """Where measured data come from."""


class CasesAndGrid(Keys):
    """The keys of a scenario file that make its cases."""

    cases: dict[CaseName, dict[str, Any]] = {}
    """What differs in each case, laid on the scenario."""
    grid: dict[str, Annotated[list[Any], Field(min_length=1)]] = {}
    """Key path: values; every combination is a case."""
    common_draws: bool = False
    """Let all points of the grid share their draws."""

    @field_validator("common_draws")
    @classmethod
    def _of_a_grid(cls, common: bool, others: ValidationInfo) -> bool:
        if common and not others.data.get("grid"):
            raise ValueError("there is no grid; cases share draws where draws has one name in all")
        return common


class ScenarioFile(CasesAndGrid, Scenario):
    """A scenario file: a scenario, and its cases or a grid that makes them."""


def scenario_model(base: type[Scenario] = Scenario) -> Any:
    """Return the scenario's model with the catalog's kinds in their places."""
    return _scenario_model(base, _catalog())


def measured_model() -> Any:
    """Return the model of `measured` alone, with the catalog's kinds."""
    return _measured_model(_catalog())


def _catalog() -> tuple[tuple[type[Part], ...], ...]:
    """Return what the models are made of: they are made anew where a plug-in changes it."""
    return tuple(map(tuple, CATALOG.values()))


@cache
def _scenario_model(base: type[Scenario], _: Any) -> Any:
    estimator = _filled(Estimator, _optional("recovery", "problem", "start", "filter"))
    named = {role: _by_name(_kinds(role)) for role in ("observers", "sensors", "starts")}
    alone = _optional("target", "orbit", "motion", "measured")
    return _filled(base, alone | named | {"estimators": _by_name(estimator)})


@cache
def _measured_model(_: Any) -> Any:
    return _filled(Measured, {"measured": _kinds("measured")})


def _filled(base: type[Keys], kinds: dict[str, Any]) -> Any:
    """Return a model with what some of its keys may hold, which say the same and default so."""
    places = {name: (value, base.model_fields[name]) for name, value in kinds.items()}
    create: Any = create_model
    return create(base.__name__, __base__=base, __doc__=base.__doc__, **places)


def _optional(*roles: str) -> dict[str, Any]:
    return {role: _kinds(role) | None for role in roles}


def _by_name(value: Any) -> Any:
    return dict[PartName, value]


def _kinds(role: str) -> Any:
    parts: Sequence[Any] = CATALOG[role]
    if len({kind_of(part) for part in parts}) != len(parts):
        raise ValueError(f"the catalog has two parts of one kind in {role!r}")
    union = reduce(or_, parts)
    return Annotated[union, Field(discriminator="kind")] if len(parts) > 1 else union
