"""One file of results: what is known of it, and its data when they are asked for."""

from collections.abc import Container
from pathlib import Path
from typing import Any, NamedTuple

from debrisest.arrays import Data
from debrisest.results import store
from debrisest.results.address import Address
from debrisest.results.told import axes_told
from debrisest.results.trajectories import is_trajectory
from debrisest.vocabulary import VOCABULARY


class Chunk(NamedTuple):
    """A file of results: what it holds, without its data."""

    address: Address
    path: Path
    runs: int
    """How many runs of it are read."""
    attributes: dict[str, Any]
    digest: str = ""
    """Of its label, which has that of its numbers."""

    def is_whole(self, index: int) -> bool:
        """Return whether it has the trajectories of the run of this index in it."""
        return index < int(self.attributes.get("whole_runs", self.runs))

    @property
    def datasets(self) -> set[str]:
        """Return the names of its datasets."""
        return self._axes.keys() & VOCABULARY.keys()

    @property
    def _axes(self) -> dict[str, int]:
        """Return how many axes each of its datasets has, as its label tells."""
        return axes_told(self.attributes["datasets"])

    def datasets_of_run(self, index: int) -> set[str]:
        """Return the names of the datasets of the run of this index that are kept."""
        whole, stage, axes = self.is_whole(index), self.address.stage, self._axes
        return {n for n in self.datasets if whole or not is_trajectory(n, stage, axes[n])}

    def read_run(self, index: int) -> Data:
        """Return the datasets of the run of this index, without trajectories that are not kept."""
        return self.read(self.datasets_of_run(index), index, index + 1)

    def read(
        self, names: Container[str] = VOCABULARY, first: int = 0, runs: int | None = None
    ) -> Data:
        """Return datasets of its runs ``first`` up to ``runs``.

        Raises UserError if it is damaged, or was replaced by another since it was found.
        """
        last = self.runs if runs is None else min(runs, self.runs)
        expected = self.address.attributes | {
            "stage_key": self.attributes.get("stage_key"),
            "runs": self.runs,
        }
        return store.read(self.path, last, names, first, expected)
