"""What a scenario can name: the base of every part, and what each role must be able to do."""

from abc import ABC, abstractmethod
from collections.abc import Collection
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple, TypeVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.filters.estimates import Estimates
from debrisest.quantity import Quantity
from debrisest.vocabulary import VOCABULARY

Window = tuple[float, float]
"""From the first time (included) to the second (excluded), in seconds."""

Vector3 = Annotated[list[float], Field(min_length=3, max_length=3)]
Positive = Annotated[float, Field(gt=0)]
NonNegative = Annotated[float, Field(ge=0)]


def _unit_quaternion(q: list[float]) -> list[float]:
    norm = float(np.linalg.norm(q))
    if not abs(norm - 1) < 1e-3:
        raise ValueError(f"a unit quaternion (scalar first) is needed; its norm is {norm:.4g}")
    return [component / norm for component in q]


UnitQuaternion = Annotated[
    list[float], Field(min_length=4, max_length=4), AfterValidator(_unit_quaternion)
]


def _ascending(limits: list[float]) -> list[float]:
    if limits[0] > limits[1]:
        raise ValueError("the lower limit comes first")
    return limits


_Number = TypeVar("_Number")
Limits = Annotated[list[_Number], Field(min_length=2, max_length=2), AfterValidator(_ascending)]
"""Lower and upper limit, such as ``Limits[Positive]``."""


class Keys(BaseModel):
    """A mapping of a scenario: unknown keys, infinities and texts for numbers are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)


class Part(Keys, ABC):
    """A part of a scenario, told apart by its ``kind``; ``version`` counts changes of results."""

    role: ClassVar[str]
    """Its place in the catalog."""
    version: ClassVar[int] = 1
    plugin: ClassVar[dict[str, str]] = {}
    """Name and digest of the plug-in that it comes from."""
    needs: ClassVar[tuple[str, ...]] = ()
    """Datasets that a part before this one must give."""
    gives: ClassVar[tuple[str, ...]] = ()
    """Datasets that later parts can count on."""
    extends: ClassVar[tuple[str, ...]] = ()
    """Those of them that several parts give together, each of them its share."""

    declares: ClassVar[dict[str, Quantity]] = {}
    """Datasets that nobody else declares, such as those of a plug-in; they join the vocabulary."""

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        """Add what the part declares to the vocabulary."""
        VOCABULARY.update(cls.declares)

    @classmethod
    def can_give(cls) -> tuple[str, ...]:
        """Return the datasets that parts of this kind give."""
        return cls.gives

    @property
    def given(self) -> tuple[str, ...]:
        """Return the datasets that this very part gives, as its keys have it."""
        return self.can_give()

    @property
    def needed(self) -> tuple[str, ...]:
        """Return the datasets that this very part needs, as its keys have it."""
        return self.needs

    def fingerprint(self) -> dict[str, Any]:
        """Return what this part's results depend on: its keys, its version, its plug-in."""
        return self.model_dump(mode="json") | {"version": self.version} | self.plugin


class SimulationPart(Part):
    """Target, orbit, motion, observer, sensor or start: adds its datasets to what is there.

    Only a simulation has a truth: nothing after the source may need it.
    """

    role = "sensors"

    truths: ClassVar[tuple[str, ...]] = ()
    """Datasets of what really happens."""
    knows: ClassVar[tuple[str, ...]] = ()
    """Datasets of what estimators are told: noise, geometry of cameras, known points."""
    measures: ClassVar[tuple[str, ...]] = ()
    """Datasets of what sensors read."""
    frames: ClassVar[dict[str, str]] = {}
    """The axes and origin of datasets whose name does not tell them."""
    tried: ClassVar[bool] = False
    """Whether the first two epochs are simulated when a scenario is read, for it to be refused."""

    @classmethod
    def can_give(cls) -> tuple[str, ...]:
        """Return the datasets that parts of this kind give, of all three groups."""
        return (*cls.truths, *cls.knows, *cls.measures)

    @abstractmethod
    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the new datasets; ``data`` holds those of the parts before this one."""

    def simulate_named(self, name: str, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the same, for a part whose datasets tell the name that the scenario gave it."""
        return self.simulate(data, clock, draws)


class SourcePart(Part):
    """Measured data from files, in the place of a simulation."""

    role = "measured"

    @abstractmethod
    def read(self, folder: Path) -> Data:
        """Return what is known and measured, of all runs, with ``run`` and ``time_s``.

        Paths count from ``folder``, the scenario's. UserError tells what is wrong with a file.
        """

    @abstractmethod
    def digest(self, folder: Path) -> str:
        """Return a checksum of what the files hold, by which a change is noticed."""


class RecoveryPart(Part):
    """Turns the measurements of single epochs into a signal over all epochs."""

    role = "recovery"

    @abstractmethod
    def recover(self, data: Data, clock: Clock) -> Data:
        """Return the recovered signal and what the solver says of it."""

    @abstractmethod
    def assess(self, data: Data) -> Data:
        """Return the recovery's errors, as far as ``data`` holds a truth."""


class StartPart(Part):
    """Says what is known before the first measurement, in physical quantities."""

    role = "start"
    guesses: ClassVar[tuple[str, ...]] = ()
    """Quantities of which it gives a first guess."""

    @classmethod
    def guessed(cls, given: Collection[str]) -> set[str]:
        """Return the same, for a start to which these datasets are given."""
        return set(cls.guesses)

    @abstractmethod
    def start(self, data: Data, clock: Clock) -> tuple[Data, Data]:
        """Return the initial guess (run, ...) by name, and the variance of its errors by name."""


class Given(NamedTuple):
    """What a filter is given beside its model."""

    state: Array
    """Initial state, (run, n); (run, 0) for a filter that makes its own start."""
    covariance: Array
    """Of its errors, (run, n_e, n_e)."""
    measured: Array
    """(run, time, m), NaN where nothing is."""
    clock: Clock
    truth: Array | None = None
    """True states (run, time, n), for a bound or a diagnostic; no estimate depends on them."""

    @property
    def known_truth(self) -> Array:
        """Return the true states; raise ValueError where they are not known."""
        if self.truth is None:
            raise ValueError("the bound is linearised at the truth, which is not known here")
        return self.truth


class ProblemPart(Part):
    """An estimation problem: what is estimated, from what, by which model.

    What it needs is known or measured; what a bound or an error needs beside it is the truth.
    """

    role = "problem"
    model_kind: ClassVar[str]
    """The kind of model that it hands to a filter."""
    start_needs: ClassVar[tuple[str, ...]] = ()
    """Quantities of which it needs a first guess."""
    true_state: ClassVar[tuple[str, ...]] = ()
    """Datasets that `truth` is made of."""

    @property
    def gives_model(self) -> str:
        """Return the kind of model that this very problem gives, as its keys have it."""
        return self.model_kind

    @property
    def start_needed(self) -> tuple[str, ...]:
        """Return the first guesses that this very problem needs, as its keys have it."""
        return self.start_needs

    @property
    def truth_needed(self) -> tuple[str, ...]:
        """Return the datasets that its truth is made of, as its keys have it."""
        return self.true_state

    @abstractmethod
    def measurements(self, data: Data) -> Array:
        """Return what the filter measures (run, time, component), NaN where nothing is."""

    @abstractmethod
    def model(self, data: Data, clock: Clock) -> Any:
        """Return process and measurement as functions of the state, as the filters know them."""

    def pack(self, guess: Data, variance: Data) -> tuple[Array, Array]:
        """Return the initial state (run, n) and covariance (run, n, n)."""
        raise ValueError("this problem takes no first guess")

    @abstractmethod
    def unpack(self, filtered: Estimates) -> Data:
        """Return the estimated quantities by name, each with its ``_sigma``."""

    @abstractmethod
    def assess(self, data: Data, scored: Window) -> Data:
        """Return the filter's errors, as far as ``data`` holds a truth."""

    def truth(self, data: Data) -> Array | None:
        """Return the true states (run, time, n) of a simulation, where a bound is possible."""
        return None


class FilterPart(Part):
    """A filter algorithm and its settings."""

    takes: ClassVar[str]
    """The kind of model that it takes."""
    needs_truth: ClassVar[bool] = False
    """Whether it is linearised at the truth, as bounds are."""
    makes_start: ClassVar[bool] = False
    """Whether it begins with the measurements alone, so that an estimator has no start."""

    @property
    def uses_truth(self) -> bool:
        """Return whether this very filter needs the truth, as its keys have it."""
        return self.needs_truth

    role = "filter"

    @property
    def kept_s(self) -> list[float] | None:
        """Return when covariances are kept beside the last epoch's; None: the part does not say."""
        return getattr(self, "keep_s", None)

    @abstractmethod
    def run(self, model: Any, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
