"""What a scenario can name: the base of every part, and what each role must be able to do."""

from abc import ABC, abstractmethod
from typing import Annotated, Any, ClassVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.filters.history import History
from debrisest.filters.model import Model

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


class Keys(BaseModel):
    """A mapping of a scenario: unknown keys, infinities and texts for numbers are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, strict=True)


class Part(Keys, ABC):
    """A part of a scenario, told apart by its ``kind``; ``version`` counts changes of results."""

    version: ClassVar[int] = 1
    needs: ClassVar[tuple[str, ...]] = ()
    """Datasets that a part before this one must give."""
    gives: ClassVar[tuple[str, ...]] = ()
    """Datasets that later parts can count on."""

    def fingerprint(self) -> dict[str, Any]:
        """Return what this part's results depend on: its keys and its version."""
        return self.model_dump(mode="json") | {"version": self.version}


class SimulationPart(Part):
    """Target, orbit, motion, observer or sensor: adds its datasets to what is there already."""

    frames: ClassVar[dict[str, str]] = {}
    """The axes and origin of datasets whose name does not tell them."""

    @abstractmethod
    def simulate(self, data: Data, clock: Clock, draws: Draws) -> Data:
        """Return the new datasets; ``data`` holds those of the parts before this one."""


class RecoveryPart(Part):
    """Turns the measurements of single epochs into a signal over all epochs."""

    @abstractmethod
    def recover(self, data: Data, clock: Clock) -> Data:
        """Return the recovered signal and what the solver says of it."""

    @abstractmethod
    def assess(self, data: Data) -> Data:
        """Return the recovery's errors, as far as ``data`` holds a truth."""


class StartPart(Part):
    """Says what is known before the first measurement, in physical quantities."""

    @abstractmethod
    def start(self, data: Data, clock: Clock) -> tuple[Data, dict[str, float]]:
        """Return the initial guess by name, and its variance by name."""


class ProblemPart(Part):
    """An estimation problem: what is estimated, from what, by which model."""

    @abstractmethod
    def measurements(self, data: Data) -> Array:
        """Return what the filter measures (run, time, component), NaN where nothing is."""

    @abstractmethod
    def model(self, clock: Clock) -> Model:
        """Return process and measurement as functions of the state."""

    @abstractmethod
    def pack(self, guess: Data, variance: dict[str, float]) -> tuple[Array, Array]:
        """Return the initial state (run, n) and covariance (run, n, n)."""

    @abstractmethod
    def unpack(self, history: History) -> Data:
        """Return the estimated quantities by name, each with its ``_sigma``."""

    @abstractmethod
    def assess(self, data: Data, scored: Window) -> Data:
        """Return the filter's errors, as far as ``data`` holds a truth."""


class FilterPart(Part):
    """A filter algorithm and its settings."""

    @abstractmethod
    def run(self, model: Model, state: Array, covariance: Array, measured: Array) -> History:
        """Return the history of the estimate over all epochs."""
