"""Recover: a signal over all epochs from the measurements of single epochs."""

from typing import Any

from debrisest.arrays import Data
from debrisest.clock import Clock
from debrisest.runner.stages.reason import about
from debrisest.scenario.case import Case

VERSION = 1


def inputs(case: Case, estimator: str) -> dict[str, Any]:
    """Return everything that the result of this stage depends on, beside the simulation."""
    recovery = case.scenario.estimators[estimator].recovery
    assert recovery is not None
    return {"version": VERSION, "recovery": recovery.fingerprint()}


def run(case: Case, estimator: str, data: Data) -> Data:
    """Return what the estimator's recovery makes of the measurements."""
    recovery = case.scenario.estimators[estimator].recovery
    assert recovery is not None
    with about(f"estimators.{estimator}.recovery", recovery):
        return recovery.recover(data, Clock(data["time_s"]))
