"""The stages in the order in which data passes through them."""

from collections.abc import Callable
from typing import Any, NamedTuple

from debrisest.arrays import Data
from debrisest.runner.stages import assess, filter, recover, simulate
from debrisest.scenario.case import Case


class Stage(NamedTuple):
    """A stage: what its result depends on, how it is computed, and how many runs at once."""

    name: str
    inputs: Callable[[Case, str], dict[str, Any]]
    run: Callable[[Case, str, Data], Data]
    runs_together: Callable[[Case, str], int] = lambda case, estimator: 1


STAGES = {
    "simulate": Stage("simulate", simulate.inputs, simulate.run, simulate.runs_together),
    "recover": Stage("recover", recover.inputs, recover.run),
    "filter": Stage("filter", filter.inputs, filter.run, filter.runs_together),
    "assess": Stage("assess", assess.inputs, assess.run),
}


def stages_of(case: Case, estimator: str) -> list[str]:
    """Return the names of the stages that an estimator has after ``simulate``."""
    chosen = case.scenario.estimators[estimator]
    has = {"recover": chosen.recovery is not None, "filter": chosen.filter is not None}
    return [name for name in ("recover", "filter", "assess") if has.get(name, True)]
