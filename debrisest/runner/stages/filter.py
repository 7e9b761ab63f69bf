"""Filter: start, model and algorithm of an estimator, put together."""

from typing import Any

import numpy as np

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.roles import Given
from debrisest.runner.stages.reason import about
from debrisest.scenario.case import Case

VERSION = 1


def inputs(case: Case, estimator: str) -> dict[str, Any]:
    """Return everything that the result of this stage depends on, beside what it reads."""
    chosen = case.scenario.estimators[estimator]
    parts = {"problem": chosen.problem, "start": chosen.start, "filter": chosen.filter}
    return {
        "version": VERSION,
        **{role: part.fingerprint() for role, part in parts.items() if part is not None},
    }


def runs_together(case: Case, estimator: str) -> int:
    """Return how many runs the filter computes fastest in one call."""
    algorithm = case.scenario.estimators[estimator].filter
    assert algorithm is not None
    return algorithm.runs_together


def run(case: Case, estimator: str, data: Data) -> Data:
    """Return the estimates over all epochs, and what the filter says of itself."""
    chosen, clock = case.scenario.estimators[estimator], Clock(data["time_s"])
    problem, start, algorithm = chosen.problem, chosen.start, chosen.filter
    assert problem is not None and algorithm is not None
    path = f"estimators.{estimator}"
    packed = np.empty((len(data["run"]), 0)), np.empty((len(data["run"]), 0, 0))
    if start is not None:
        with about(f"{path}.start", start):
            guess = start.start(data, clock)
        with about(f"{path}.problem", problem):
            packed = problem.pack(*guess)
    with about(f"{path}.problem", problem):
        model, measured = problem.model(data, clock), problem.measurements(data)
        known = all(name in data for name in problem.truth_needed)
        truth = problem.truth(data) if known else None
        given = Given(*packed, measured, clock, truth)
    with about(f"{path}.filter", algorithm):
        filtered = algorithm.run(model, given)
    with about(f"{path}.problem", problem):
        estimates = problem.unpack(filtered)
    return {
        **estimates,
        "covariance_time_s": data["time_s"][filtered.kept],
        "error_name": np.array(model.error_names),
        "covariance": filtered.covariance,
        "nis": filtered.nis,
        "nis_dof": filtered.nis_dof,
        "status": filtered.status,
        **filtered.counts,
    }
