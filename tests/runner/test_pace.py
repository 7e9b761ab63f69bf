"""The time left is made of what like steps took, in this command and before."""

from pathlib import Path

import pytest

from debrisest.results import store
from debrisest.results.address import Address
from debrisest.results.chunk import Chunk
from debrisest.runner import pace as pacing
from debrisest.runner.pace import Pace
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.step import Step
from debrisest.scenario.load import load_scenario


@pytest.fixture
def steps(small: Path, tmp_path: Path) -> list[Step]:
    return plan(load_scenario(small), tmp_path, Selection(2, ["slow", "fast"], ["wahba"]))


def chunk(address: Address, seconds: float) -> Chunk:
    return Chunk(address, Path(), 2, {"runs": 2, "cpu_s": seconds})


@pytest.fixture
def takes(monkeypatch: pytest.MonkeyPatch):
    """Let the file of each stage tell the CPU time that it is said to take."""

    def told(**seconds: float) -> None:
        def inspect(path: Path, depth: store.Depth) -> store.Checkpoint:
            stage = path.name.partition(".")[0].partition("-")[0]
            told = {"runs": 2, "cpu_s": seconds[stage]}
            return store.Checkpoint(store.Condition.WHOLE, told)

        monkeypatch.setattr(pacing.store, "inspect", inspect)

    return told


def test_what_is_left_goes_by_the_steps_of_the_same_estimator_in_other_cases(steps, takes) -> None:
    takes(simulate=1.0, recover=2.0, filter=6.0, assess=1.0)
    pace = Pace(steps)
    slow = [step for step in steps if step.address.case == "slow"]
    for step in slow[:-1]:
        pace.done(step)
        assert pace.left(1.0) is None
    pace.done(slow[-1])
    assert pace.left(5.0) == pytest.approx(5.0)
    fast = [step for step in steps if step.address.case == "fast"]
    for step in fast[:-2]:
        pace.done(step)
    assert pace.left(13.0) == pytest.approx(13.0 * 7.0 / 13.0)


def test_files_of_before_tell_it_from_the_first_step_on(steps, takes) -> None:
    takes(simulate=2.0)
    costs = {"simulate": 2.0, "recover": 2.0, "filter": 6.0, "assess": 1.0}
    known = [chunk(step.address, costs[step.address.stage]) for step in steps]
    pace = Pace(steps, known)
    assert pace.left(1.0) is None
    pace.done(steps[0])
    assert pace.left(10.0) == pytest.approx(10.0 * (2 * 11.0 - 2.0) / 2.0)


def test_a_step_of_an_estimator_that_nobody_has_run_leaves_it_open(steps, takes) -> None:
    takes(simulate=1.0)
    known = [chunk(one.address, 1.0) for one in steps if one.address.stage != "filter"]
    pace = Pace(steps, known)
    pace.done(steps[0])
    assert pace.left(1.0) is None
