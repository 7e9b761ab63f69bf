"""Progress on a terminal: what runs, how much is done, and how long it takes."""

import io
from pathlib import Path

import pytest
from rich.console import Console
from rich.progress import Progress as Bars
from rich.progress import TextColumn

from debrisest.runner import progress as telling
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.scenario.load import load_scenario


@pytest.fixture
def bars() -> Bars:
    columns = TextColumn("{task.completed} {task.fields[left]} {task.fields[now]}")
    return Bars(columns, console=Console(file=io.StringIO()), auto_refresh=False)


def test_the_bar_says_what_runs_and_what_is_left(
    small: Path, tmp_path: Path, bars: Bars, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter(range(10, 1000, 10))
    monkeypatch.setattr(telling, "monotonic", lambda: float(next(clock)))
    steps = plan(load_scenario(small), tmp_path, Selection(2, ["slow"], ["wahba"]))
    bar = telling._Bar(bars, len(steps), lambda elapsed: 3660.0)
    bar.started(steps[:2])
    fields = bars.tasks[0].fields
    assert fields["now"] == f"{steps[0].name} (and 1 more)"
    assert fields["left"] == "1:01:00 left"
    bar.done(steps[0].name)
    assert (bars.tasks[0].fields["now"], bars.tasks[0].completed) == (steps[1].name, 1)


def test_steps_last_alike_where_nobody_knows_better(
    bars: Bars, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(telling, "monotonic", lambda: 100.0)
    bar = telling._Bar(bars, 4, None)
    monkeypatch.setattr(telling, "monotonic", lambda: 130.0)
    bar.done("image 0")
    assert bars.tasks[0].fields["left"] == "0:01:30 left"
