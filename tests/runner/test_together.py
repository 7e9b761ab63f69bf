"""Runs that are computed together come out as those computed apart, to the byte."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from debrisest.arrays import Data
from debrisest.results import store
from debrisest.runner.compute import compute
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.stages.pipeline import STAGES, stages_of
from debrisest.runner.step import Step
from debrisest.scenario.case import Case
from debrisest.scenario.load import load_scenario
from debrisest.shipped import shipped_path
from debrisest.vocabulary import has_runs

RUNS = 5
CASES = {"biondi2017": ("1", 100.0), "li2011": ("clutter-10", 100.0), "pesce2017": ("A", 20.0)}
"""A case of each, and how much of it is enough, s."""


@cache
def case_of(scenario: str) -> Case:
    name, duration = CASES[scenario]
    case = load_scenario(shipped_path(scenario)).cases[name]
    return case.known_as(case.scenario.model_copy(update={"duration_s": duration}))


@cache
def simulated(scenario: str) -> Data:
    return STAGES["simulate"].run(case_of(scenario), "", {"run": np.arange(float(RUNS))})


def before_filter(scenario: str, estimator: str) -> Data:
    data = {"run": np.arange(float(RUNS)), **simulated(scenario)}
    if "recover" in stages_of(case_of(scenario), estimator):
        data |= STAGES["recover"].run(case_of(scenario), estimator, data)
    data.pop("status", None)
    return data


def same(one: np.ndarray, other: np.ndarray) -> bool:
    """Whether arrays have the same bytes; texts the same letters, whatever room is left."""
    text = one.dtype.kind == "U"
    return bool((one == other).all()) if text else one.tobytes() == other.tobytes()


def share(data: Data, runs: slice) -> Data:
    return {name: value[runs] if has_runs(name) else value for name, value in data.items()}


ESTIMATORS = [
    (scenario, estimator)
    for scenario in CASES
    for estimator, chosen in case_of(scenario).scenario.estimators.items()
    if chosen.filter is not None and chosen.filter.runs_together > 20
]


@pytest.mark.parametrize(("scenario", "estimator"), ESTIMATORS)
def test_a_filter_gives_each_run_the_same_bytes(scenario: str, estimator: str) -> None:
    data, case = before_filter(scenario, estimator), case_of(scenario)
    whole = STAGES["filter"].run(case, estimator, data)
    for runs in (slice(0, 2), slice(2, RUNS)):
        apart = STAGES["filter"].run(case, estimator, share(data, runs))
        for name, value in share(whole, runs).items():
            assert same(value, apart[name]), name


@pytest.mark.parametrize("scenario", CASES)
def test_a_simulation_gives_each_run_the_same_bytes(scenario: str) -> None:
    """However many runs a file has: more runs, or another cut, change no number."""
    for runs in (slice(0, 2), slice(2, RUNS)):
        numbers = {"run": np.arange(float(RUNS))[runs]}
        apart = STAGES["simulate"].run(case_of(scenario), "", numbers)
        for name, value in share(simulated(scenario), runs).items():
            assert same(value, apart[name]), name


def test_chunks_computed_together_have_the_files_of_chunks_computed_alone(tmp_path: Path) -> None:
    def steps(folder: str) -> dict[str, list[Step]]:
        found: dict[str, list[Step]] = {}
        for step in plan(
            load_scenario(shipped_path("first_steps")), tmp_path / folder, Selection(30)
        ):
            found.setdefault(str(step.kin), []).append(step)
        return found

    for batch in steps("together").values():
        compute(batch)
    for batch in steps("alone").values():
        for step in batch:
            compute([step])
    for path in sorted((tmp_path / "alone").rglob("*.h5")):
        one, other = (
            store.read(path),
            store.read(tmp_path / "together" / path.relative_to(tmp_path / "alone")),
        )
        assert one.keys() == other.keys()
        assert all(one[name].tobytes() == other[name].tobytes() for name in one)
