"""Assess: errors of recovery and filter against the truth, where there is one."""

from typing import Any

import numpy as np

from debrisest.arrays import Data
from debrisest.assessment.consistency import chart_free
from debrisest.assessment.silent import silent_failures
from debrisest.assessment.statistics import per_dimension
from debrisest.roles import ProblemPart, Window
from debrisest.runner.stages.reason import about
from debrisest.scenario.case import Case

VERSION = 7

_COUNTED = ("converged", "repairs", "reopened", "doubt", "doubt_at")
"""What filters count, and assess passes on."""


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
        with about(f"estimators.{estimator}.recovery", chosen.recovery):
            result |= chosen.recovery.assess(data)
    if chosen.problem is not None:
        result |= diagnostics(data)
        with about(f"estimators.{estimator}.problem", chosen.problem):
            result |= _scored(chosen.problem, data, case.scenario.scored)
        result |= silent_failures(result)
    return result


def _scored(problem: ProblemPart, data: Data, window: Window) -> Data:
    """Return the errors of the estimates; those of a filter that diverged may be infinite."""
    with np.errstate(over="ignore", invalid="ignore"):
        return problem.assess(data, window)


def diagnostics(data: Data) -> Data:
    """Return what a filter says of itself, whatever the problem: consistency and counters."""
    result: Data = {name: data[name] for name in _COUNTED if name in data}
    used = data["nis_dof"]
    if used.any():
        result |= {"nis": per_dimension(data["nis"], used), "nis_dof": used}
    if "rejected" in data:
        result["rejected"] = per_dimension(data["rejected"], data["rejected"] + used)
    if "cost_of_truth" in data:
        numbers = data.get("cost_numbers", np.array([len(data["error_name"])]))[:, None]
        result["w"] = chart_free(data["cost_of_truth"], data["cost"], numbers)
        result["w_dof"] = np.where(np.isfinite(result["w"]), numbers, 0)
    return result
