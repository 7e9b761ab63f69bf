"""Filter: start, model and algorithm of an estimator, put together."""

from typing import Any

import numpy as np

from debrisest.arrays import Data
from debrisest.filters.history import FilterStatus
from debrisest.outcome import sentences
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
    model = problem.model(clock)
    state, covariance = problem.pack(*start.start(data, clock))
    history = algorithm.run(model, state, covariance, problem.measurements(data))
    return problem.unpack(history) | {
        "covariance_time_s": data["time_s"][history.kept],
        "error_name": np.array(model.error_names),
        "covariance": history.covariance,
        "nis": history.nis,
        "nis_dof": history.nis_dof,
        "repairs": history.repairs,
        "status": sentences(history.status, FilterStatus),
    }
