"""What an estimator is made of: a recovery, a start, a problem and a filter."""

from abc import abstractmethod
from collections.abc import Collection
from typing import Any, ClassVar, NamedTuple

from debrisest.arrays import Array, Data
from debrisest.clock import Clock
from debrisest.filters.estimates import Estimates
from debrisest.roles.keys import Window
from debrisest.roles.part import Part


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


class FilterPart(Part):
    """A filter algorithm and its settings."""

    role = "filter"
    takes: ClassVar[str]
    """The kind of model that it takes."""
    needs_truth: ClassVar[bool] = False
    """Whether it is linearised at the truth, as bounds are."""
    runs_together: ClassVar[int] = 20
    """How many runs it computes fastest in one call, as measured; no result depends on it."""
    makes_start: ClassVar[bool] = False
    """Whether it begins with the measurements alone, so that an estimator has no start."""

    @property
    def uses_truth(self) -> bool:
        """Return whether this very filter needs the truth, as its keys have it."""
        return self.needs_truth

    @property
    def kept_s(self) -> list[float] | None:
        """Return when covariances are kept beside the last epoch's; None: the part does not say."""
        return getattr(self, "keep_s", None)

    @abstractmethod
    def run(self, model: Any, given: Given) -> Estimates:
        """Return the estimates of all epochs."""
