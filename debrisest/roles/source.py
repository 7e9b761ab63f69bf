"""Where data come from: parts that simulate them, and parts that read them from files."""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, ClassVar

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.draws import Draws
from debrisest.roles.part import Part


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
    runs_together: ClassVar[int] = 100
    """How many runs it simulates in one call, as memory allows; no result depends on it."""

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

    @property
    def files(self) -> list[str]:
        """Return all files, and folders of files, that this part reads, as its keys have them."""
        return []

    def keys_with(self, path_of: Callable[[str], str]) -> dict[str, Any]:
        """Return the keys that are set, with another path in the place of each file's."""
        keys = self.model_dump(mode="json", exclude_none=True)
        placed = {key: _replaced(value, self.files, path_of) for key, value in keys.items()}
        return placed | {"kind": keys["kind"]}

    @abstractmethod
    def read(self, folder: Path) -> Data:
        """Return what is known and measured, of all runs, with ``run`` and ``time_s``.

        Paths count from ``folder``, the scenario's. UserError tells what is wrong with a file.
        """

    @abstractmethod
    def digest(self, folder: Path) -> str:
        """Return a checksum of what the files hold, by which a change is noticed."""


def _replaced(value: Any, files: Sequence[str], path_of: Callable[[str], str]) -> Any:
    if isinstance(value, list):
        return [_replaced(one, files, path_of) for one in value]
    return path_of(value) if isinstance(value, str) and value in files else value
