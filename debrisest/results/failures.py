"""The runs that gave no result."""

from collections.abc import Iterable
from typing import NamedTuple

from debrisest.results.address import Address
from debrisest.results.chunk import Chunk


class Failure(NamedTuple):
    """A run that gave no result: the first stage that failed, and why."""

    address: Address
    run: int
    why: str

    @property
    def name(self) -> str:
        """Return what the run is called in messages."""
        return f"{self.address.name}, run {self.run}"


def failures_of(chunks: Iterable[Chunk]) -> list[Failure]:
    """Return the failed runs of files, upstream first; one not simulated counts only once.

    Only files that say that runs failed are read.
    """
    found: dict[tuple[str, str, int], Failure] = {}
    for chunk in (one for one in chunks if one.attributes.get("failed_runs", 1)):
        case, estimator = chunk.address.case, chunk.address.estimator
        simulation = chunk.attributes.get("simulation", case)
        data = chunk.read(("run", "failure"))
        for run, why in zip(data["run"].astype(int).tolist(), data["failure"].tolist()):
            if why and (simulation, "", run) not in found:
                found.setdefault((case, estimator, run), Failure(chunk.address, run, why))
    return list(found.values())
