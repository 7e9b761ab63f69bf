"""How the runs of a case are cut into files, whatever computes them."""

from collections.abc import Iterator

from debrisest.runner.stages.pipeline import STAGES
from debrisest.scenario.case import Case

RUNS_PER_FILE, MOST_PER_FILE = 20, 100


def cut(case: Case, estimator: str, runs: int) -> Iterator[tuple[int, int]]:
    """Yield the first run of each file, and how many it has, of an estimator or a simulation ("").

    Runs that are computed together lie together, up to MOST_PER_FILE, but for the first few, which
    are kept where more are wanted later. Files of an estimator lie within those of the simulation.
    """
    first, together = 0, min(runs_together(case, ""), runs_together(case, estimator))
    while first < runs:
        wide = first and together >= MOST_PER_FILE
        end = (first // MOST_PER_FILE + 1) * MOST_PER_FILE if wide else first + RUNS_PER_FILE
        yield first, min(end, runs) - first
        first = end


def runs_together(case: Case, estimator: str) -> int:
    """Return how many runs the longest step of an estimator, or a simulation, has in one call."""
    if not estimator:
        return STAGES["simulate"].runs_together(case, "")
    has_filter = case.scenario.estimators[estimator].filter is not None
    return STAGES["filter"].runs_together(case, estimator) if has_filter else RUNS_PER_FILE
