"""What a scenario file may hold. The kinds come from the catalog."""

from collections.abc import Sequence
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any, Literal

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
from debrisest.scenario.mistakes import allowed_names
from debrisest.scenario.names import CaseName, Line, PartName, TableName
from debrisest.scenario.window import WindowText, window_of
from debrisest.vocabulary import VOCABULARY, possible_units


def _known_quantity(name: str) -> str:
    if name not in (shown := _quantities()):
        raise ValueError(f"no table can show {name!r}; {allowed_names(name, shown)}")
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


class Divergence(Keys):
    """A run has diverged if a quantity over a window, by default its RMS, is above a limit."""

    quantity: QuantityName
    above: Positive = Field(description="in the unit of the tables")
    window: WindowText
    statistic: StatisticName = Field("rms", description="as it is over the window of one run")


class Table(Keys):
    """Cells: every quantity by every statistic and window, for each case and estimator.

    What was simulated has no estimator.
    """

    table: TableName = Field(description="the paper's number, or a short word")
    title: Line
    stage: Literal["simulate", "recover", "filter"]
    quantities: Annotated[list[QuantityName], Field(min_length=1)]
    statistics: Annotated[list[StatisticName], Field(min_length=1)]
    windows: Annotated[list[WindowText], Field(min_length=1)]
    cases: list[str] | None = Field(None, description="names of cases or means; default: all")
    units: dict[QuantityName, str] = Field({}, description="quantity: another unit than its own")
    count_diverged: bool = Field(False, description="let runs that diverged count as well")

    @model_validator(mode="after")
    def _known_units(self) -> "Table":
        for name, unit in self.units.items():
            allowed = possible_units(name)
            if unit not in allowed:
                raise ValueError(
                    f"{name} cannot be shown in {unit!r}; allowed: {', '.join(allowed)}"
                )
        return self


class Tables(Keys):
    """How results are scored and laid out."""

    published: str | None = Field(None, description="CSV of published values, beside the scenario")
    scored_window: WindowText | None = Field(None, description="where axes are relabeled")
    diverged: list[Divergence] = []
    means: dict[CaseName, list[str]] = Field({}, description="name of a mean: its cases")
    layout: list[Table] = []


class Estimator(Keys):
    """Recovery, start and filter, as far as an estimator has them."""

    recovery: RecoveryPart | None = None
    problem: ProblemPart | None = None
    start: StartPart | None = None
    filter: FilterPart | None = None
    cases: list[str] | None = Field(None, description="where it is used; default: everywhere")
    bound: str = Field("bound", description="estimator that stands in the column bound of tables")

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
    source: Line = ""
    seed: Annotated[int, Field(ge=0, lt=2**63)]
    draws: CaseName | None = Field(
        None, description="name that draws are bound to; default: the case's own"
    )
    runs: Annotated[int, Field(ge=1, le=MOST_RUNS)]
    keep: Annotated[int, Field(ge=1)] | Literal["all"] = Field(
        1, description="runs whose trajectories are kept, the first ones, or `all`"
    )
    duration_s: Positive
    step_s: Positive | None = None
    measured: SourcePart | None = None
    target: SimulationPart | None = None
    orbit: SimulationPart | None = None
    motion: SimulationPart | None = None
    observers: dict[str, SimulationPart] = {}
    sensors: dict[str, SimulationPart] = {}
    starts: dict[str, SimulationPart] = {}
    estimators: dict[PartName, Estimator]
    tables: Tables = Tables()

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


class CasesAndGrid(Keys):
    """The keys of a scenario file that make its cases."""

    cases: dict[CaseName, dict[str, Any]] = Field({}, description="name: what differs in this case")
    grid: dict[str, Annotated[list[Any], Field(min_length=1)]] = Field(
        {}, description="key.path: values; every combination is a case"
    )
    common_draws: bool = Field(False, description="let all points of the grid share their draws")

    @field_validator("common_draws")
    @classmethod
    def _of_a_grid(cls, common: bool, others: ValidationInfo) -> bool:
        if common and not others.data.get("grid"):
            raise ValueError("there is no grid; cases share draws where draws has one name in all")
        return common


class ScenarioFile(Scenario, CasesAndGrid):
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
    create: Any = create_model
    roles = ("recovery", "problem", "start", "filter")
    optional = {role: (_kinds(role) | None, None) for role in roles}
    estimator = create("Estimator", __base__=Estimator, **optional)
    return create(
        base.__name__,
        __base__=base,
        target=(_kinds("target") | None, None),
        orbit=(_kinds("orbit") | None, None),
        motion=(_kinds("motion") | None, None),
        observers=(_by_name(_kinds("observers")), {}),
        measured=(_kinds("measured") | None, None),
        sensors=(_by_name(_kinds("sensors")), {}),
        starts=(_by_name(_kinds("starts")), {}),
        estimators=(_by_name(estimator), ...),
    )


@cache
def _measured_model(_: Any) -> Any:
    create: Any = create_model
    return create("Measured", __base__=Measured, measured=(_kinds("measured"), ...))


def _by_name(value: Any) -> Any:
    return dict[PartName, value]


def _kinds(role: str) -> Any:
    parts: Sequence[Any] = CATALOG[role]
    if len({kind_of(part) for part in parts}) != len(parts):
        raise ValueError(f"the catalog has two parts of one kind in {role!r}")
    union = reduce(or_, parts)
    return Annotated[union, Field(discriminator="kind")] if len(parts) > 1 else union
