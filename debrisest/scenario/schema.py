"""What a scenario file may hold, but for the kinds of its parts."""

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, field_validator, model_validator

from debrisest.clock import Clock
from debrisest.roles import (
    FilterPart,
    Keys,
    Positive,
    ProblemPart,
    RecoveryPart,
    SimulationPart,
    SourcePart,
    StartPart,
    Window,
)
from debrisest.scenario.names import CaseName, Line, PartName
from debrisest.scenario.table_keys import Tables
from debrisest.scenario.window import window_of


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
