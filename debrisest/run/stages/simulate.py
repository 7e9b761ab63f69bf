"""Simulate: truth and measurements of a case, part by part."""

from typing import Any

from debrisest.arrays import Data
from debrisest.draws import Draws
from debrisest.scenario.load import Case

VERSION = 1


def inputs(case: Case, _: str) -> dict[str, Any]:
    """Return everything that the result of this stage depends on."""
    scenario = case.scenario
    return {
        "version": VERSION,
        "case": case.name,
        **scenario.model_dump(mode="json", include={"seed", "duration_s", "step_s"}),
        **{name: part.fingerprint() for name, part in scenario.simulation.items()},
    }


def run(case: Case, _: str, data: Data) -> Data:
    """Return truth and measurements of the runs whose numbers are in ``data``."""
    scenario = case.scenario
    draws = Draws(scenario.seed, case.name, data["run"].astype(int).tolist())
    result: Data = {"time_s": scenario.clock.times}
    for path, part in scenario.simulation.items():
        name = path.partition(".")[2]
        result |= part.simulate_named(name, result, scenario.clock, draws)
    return result
