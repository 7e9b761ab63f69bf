"""Files hold the runs that are computed together, and none is lost where more runs are wanted."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from debrisest.parts.filters.kalman import Unscented
from debrisest.results import store
from debrisest.runner.cut import cut
from debrisest.scenario.case import Case
from debrisest.scenario.load import load_scenario
from debrisest.shipped import shipped_path


def case_of(scenario: str, case: str) -> Case:
    return load_scenario(shipped_path(scenario)).cases[case]


IMAGES = next(iter(load_scenario(shipped_path("pesce2017-images")).cases))
MANY, FEW = case_of("pesce2017", "B"), case_of("volpe2017", "nominal")


@pytest.mark.parametrize(
    ("case", "estimator", "ends"),
    [
        (MANY, "best", [20, 100, 200, 230]),
        (MANY, "", [20, 100, 200, 230]),
        (FEW, "best", [*range(20, 230, 20), 230]),
        (case_of("pesce2017-images", IMAGES), "", [*range(20, 230, 20), 230]),
    ],
)
def test_files_end_where_as_many_runs_are_computed(
    case: Case, estimator: str, ends: list[int]
) -> None:
    assert [first + runs for first, runs in cut(case, estimator, 230)] == ends


@given(st.integers(1, 500), st.sampled_from([MANY, FEW]))
def test_files_of_an_estimator_lie_within_those_of_the_simulation(runs: int, case: Case) -> None:
    def sets(estimator: str) -> list[set[int]]:
        return [set(range(first, first + n)) for first, n in cut(case, estimator, runs)]

    assert sorted(run for one in sets("best") for run in one) == list(range(runs))
    assert all(any(one <= outer for outer in sets("")) for one in sets("best"))


def held(folder: Path, stage: str) -> dict[int, tuple[int, int]]:
    """Runs, and when they were written, by the first run of each file."""
    found = {}
    for path in folder.glob(f"{stage}*.h5"):
        told = store.inspect(path).attributes
        found[told["first_run"]] = (told["runs"], path.stat().st_mtime_ns)
    return found


def test_more_runs_leave_what_is_there_and_another_cut_leaves_nothing_twice(
    tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenario, of = shipped_path("first_steps"), ("--case", "noise_m=0.01")
    folder = tmp_path / "first_steps" / "noise_m=0.01"
    with monkeypatch.context() as patch:
        patch.setattr(Unscented, "runs_together", 20)
        assert sweep(scenario, tmp_path, *of, "--runs", 45).exit_code == 0
        before = held(folder, "filter")
        assert sweep(scenario, tmp_path, *of, "--runs", 50).exit_code == 0
    assert {first: runs for first, (runs, _) in held(folder, "simulate").items()} == {0: 20, 20: 30}
    after = held(folder, "filter")
    assert [after[first] == before[first] for first in (0, 20, 40)] == [True, True, False]
    assert sweep(scenario, tmp_path, *of, "--runs", 50).exit_code == 0
    wide = held(folder, "filter")
    assert {first: runs for first, (runs, _) in wide.items()} == {0: 20, 20: 30}
    assert wide[0] == before[0]
