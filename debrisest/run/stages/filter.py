"""Filter: start, model and algorithm of an estimator, put together."""

from typing import Any

import numpy as np

from debrisest.arrays import Data
from debrisest.roles import Given
from debrisest.scenario.load import Case

VERSION = 1


def inputs(case: Case, estimator: str) -> dict[str, Any]:
    """Return everything that the result of this stage depends on, beside what it reads."""
    chosen = case.scenario.estimators[estimator]
    parts = {"problem": chosen.problem, "start": chosen.start, "filter": chosen.filter}
    return {
        "version": VERSION,
        **{role: part.fingerprint() for role, part in parts.items() if part is not None},
    }


def run(case: Case, estimator: str, data: Data) -> Data:
    """Return the estimates over all epochs, and what the filter says of itself."""
    chosen, clock = case.scenario.estimators[estimator], case.scenario.clock
    problem, start, algorithm = chosen.problem, chosen.start, chosen.filter
    assert problem is not None and start is not None and algorithm is not None
    model = problem.model(data, clock)
    state, covariance = problem.pack(*start.start(data, clock))
    measured = problem.measurements(data)
    given = Given(state, covariance, measured, clock, problem.truth(data))
    filtered = algorithm.run(model, given)
    return {
        **problem.unpack(filtered),
        "covariance_time_s": data["time_s"][filtered.kept],
        "error_name": np.array(model.error_names),
        "covariance": filtered.covariance,
        "nis": filtered.nis,
        "nis_dof": filtered.nis_dof,
        "status": filtered.status,
        **filtered.counts,
    }
