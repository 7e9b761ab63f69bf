"""Simulate: known and measured data of a case, part by part, with their truth; or from files."""

from pathlib import Path
from typing import Any

from debrisest.arrays import Data
from debrisest.draws import Draws
from debrisest.runner.stages.reason import about
from debrisest.scenario.case import Case

VERSION = 1


def inputs(case: Case, _: str) -> dict[str, Any]:
    """Return everything that the result of this stage depends on."""
    scenario = case.scenario
    parts = {name: part.fingerprint() for name, part in scenario.simulation.items()}
    if case.source:
        names = case.source.keys_with(lambda name: Path(name).name)
        source = case.source.fingerprint() | names | {"digest": case.measured_digest}
        return {"version": VERSION, "measured": source, **parts}
    told = scenario.model_dump(mode="json", include={"seed", "duration_s", "step_s"})
    return {"version": VERSION, "case": case.draws, **told, **parts}


def runs_together(case: Case, _: str) -> int:
    """Return how many runs are simulated in one call; of measured data, which files have, few."""
    return min((part.runs_together for part in case.scenario.simulation.values()), default=1)


def run(case: Case, _: str, data: Data) -> Data:
    """Return what is known and measured of the runs whose numbers are in ``data``."""
    scenario, clock, runs = case.scenario, case.clock, data["run"].astype(int)
    draws = Draws(scenario.seed, case.draws, runs.tolist())
    result: Data = case.measured_runs(runs) if case.source else {"time_s": clock.times}
    for path, part in scenario.simulation.items():
        name = path.partition(".")[2]
        with about(path, part):
            result |= part.simulate_named(name, result, clock, draws)
    return result
