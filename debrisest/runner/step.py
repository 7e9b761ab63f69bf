"""One stage of some runs of a case: what it reads, what it writes, and why it is due."""

from dataclasses import dataclass
from pathlib import Path

from debrisest.results.status import Wanted
from debrisest.runner.stages.pipeline import STAGES
from debrisest.scenario.case import Case


@dataclass(frozen=True, kw_only=True)
class Step(Wanted):
    """One stage of one chunk of runs: reads its upstream files, writes its own."""

    case: Case
    upstream: tuple["Step", ...]
    then: "Step | None" = None
    """The step that is computed with this one: it needs trajectories that are not all kept."""
    computed_before: bool = False
    """Whether it is such a step, of which nothing is left to do when its turn comes."""
    same: Path | None = None
    """The file of another variant that is the same, to be linked in the place of a computation."""

    @property
    def is_due(self) -> bool:
        """Return whether it has to be computed."""
        return bool(self.reason) and self.same is None

    @property
    def end(self) -> int:
        """Return the run after its last."""
        return self.address.first_run + self.runs

    @property
    def kin(self) -> tuple[str, ...]:
        """Return what steps have in common that differ in their runs alone."""
        return self.address[:-1]

    @property
    def together(self) -> int:
        """Return how many runs of such steps are best computed in one call."""
        return STAGES[self.address.stage].runs_together(self.case, self.address.estimator)
