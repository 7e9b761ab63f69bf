"""Steps run in order, each after what it reads."""

from concurrent.futures import Executor, Future
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from debrisest.runner.execute import execute
from debrisest.runner.schedule import Schedule


def steps_of(parents: list[set[int]]) -> list[Any]:
    steps: list[Any] = []
    for index, before in enumerate(parents):
        upstream = tuple(steps[one % index] for one in sorted(before)) if index else ()
        steps.append(
            SimpleNamespace(
                path=Path(str(index)),
                upstream=upstream,
                reason="due",
                kin=index % 3,
                together=2,
                runs=1,
            )
        )
    return steps


@given(st.lists(st.sets(st.integers(0, 50), max_size=3), max_size=30), st.integers(1, 4))
def test_each_runs_once_after_its_upstream(parents: list[set[int]], width: int) -> None:
    steps, seen = steps_of(parents), []
    schedule = Schedule(steps, width)
    while ready := schedule.take():
        assert len(ready) <= 2
        assert len({step.kin for step in ready}) == 1
        for step in ready:
            assert {up.path for up in step.upstream} <= {done.path for done in seen}
        for step in ready:
            seen.append(step)
            schedule.done(step)
    assert sorted(int(str(step.path)) for step in seen) == list(range(len(steps)))


def test_what_needs_a_failed_step_does_not_run() -> None:
    """1 and 2 need 0, 3 needs 2, 4 needs nothing."""

    class Failing(Executor):
        def submit(self, _: Any, batch: Any, /, *args: Any, **__: Any) -> Future[Any]:
            future: Future[Any] = Future()
            if any(step.path == Path("2") for step in batch):
                future.set_exception(ValueError("no"))
            else:
                future.set_result(None)
            return future

    steps = steps_of([set(), {0}, {0}, {0, 2}, set()])
    outcomes = list(execute(steps, Failing(), 2))
    told = {str(outcome.step.path): outcome.error for outcome in outcomes}
    assert told == {"0": "", "1": "", "2": "ValueError: no", "4": ""}


def test_like_steps_are_taken_together_but_leave_the_other_worker_its_share() -> None:
    """Ten alike: no more than asked, and no more than half of what is left, of two workers."""
    steps = steps_of([set()] * 10)
    for step in steps:
        step.kin, step.together = "same", 4
    schedule = Schedule(steps, 2)
    assert [len(schedule.take()) for _ in range(5)] == [4, 3, 2, 1, 0]


def test_like_steps_keep_their_order() -> None:
    steps = steps_of([set()] * 6)
    schedule = Schedule(steps)
    assert [[int(str(step.path)) for step in schedule.take()] for _ in range(3)] == [
        *([0, 3], [1, 4], [2, 5])
    ]
