"""How far a long step is reaches whoever shows it, from worker processes too."""

import time

import pytest

from debrisest.counted import Part, counted, heard_by, tell, within
from debrisest.runner.executors import WorkerPool
from debrisest.runner.progress import progress


def test_parts_are_told_after_they_are_done_with_the_name_of_their_step() -> None:
    told: list[Part] = []
    with heard_by(told.append), within("nominal: simulate"):
        for number, _ in enumerate(counted("abc", "letters")):
            assert len(told) == number
    assert told == [Part("nominal: simulate", "letters", done, 3) for done in (1, 2, 3)]
    tell("letters", 4, 4)
    assert len(told) == 3


def test_workers_tell_their_parent() -> None:
    told: list[Part] = []
    with heard_by(told.append), WorkerPool(2) as pool:
        pool.submit(tell, "images", 1, 2).result()
        pool.submit(tell, "images", 2, 2).result()
    end = time.monotonic() + 60.0
    while len(told) < 2 and time.monotonic() < end:
        time.sleep(0.01)
    assert sorted(told) == [Part("", "images", 1, 2), Part("", "images", 2, 2)]


def test_lines_tell_tenths(capsys: pytest.CaptureFixture[str]) -> None:
    with progress(1) as teller, heard_by(teller.part):
        for what in ("images", "depth"):
            list(counted(range(200), what))
        teller.done("the step")
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 2 * 11 + 1
    assert lines[10] == "  images 200 of 200"
    assert lines[-1] == "[1/1] the step"


def test_quiet_tells_no_parts(capsys: pytest.CaptureFixture[str]) -> None:
    with progress(1, quiet=True) as teller, heard_by(teller.part):
        list(counted(range(20), "images"))
    assert capsys.readouterr().err == ""


def test_a_terminal_shows_a_bar_for_the_parts_of_each_step(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    monkeypatch.setenv("COLUMNS", "120")
    with progress(1) as teller, heard_by(teller.part), within("a: simulate"):
        list(counted(range(20), "images rendered"))
        list(counted(range(7), "images placed"))
        teller.done("a: simulate")
    shown = capsys.readouterr().err
    assert "1/1" in shown and "a: simulate" in shown
    assert "images" not in shown.splitlines()[-1]
