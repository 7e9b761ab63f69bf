"""Assess: errors of recovery and filter against the truth, where there is one."""

from typing import Any

from debrisest.arrays import Data
from debrisest.scenario.load import Case

VERSION = 1


def inputs(case: Case, estimator: str) -> dict[str, Any]:
    """Return everything that the result of this stage depends on, beside what it reads."""
    chosen = case.scenario.estimators[estimator]
    parts = {"recovery": chosen.recovery, "problem": chosen.problem}
    return {
        "version": VERSION,
        "scored": list(case.scenario.scored),
        "part_versions": {name: part.version for name, part in parts.items() if part is not None},
    }


def run(case: Case, estimator: str, data: Data) -> Data:
    """Return one dataset per quantity of the tables."""
    chosen = case.scenario.estimators[estimator]
    result: Data = {}
    if chosen.recovery is not None:
        result |= chosen.recovery.assess(data)
    if chosen.problem is not None:
        result |= chosen.problem.assess(data, case.scenario.scored)
    return result
