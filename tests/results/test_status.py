"""What is out of date and why, and how runs ended, from the files and in words."""

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from debrisest.parts.recoveries.basis_pursuit import BasisPursuit
from debrisest.recovery.basis_pursuit import RecoveryStatus
from debrisest.results.open import find_results
from debrisest.results.overview import Row, overview
from debrisest.results.status import up_to_date
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.scenario.load import load_scenario

LIMIT = f"recover: {RecoveryStatus.ITERATION_LIMIT.sentence}"
CHANGED = ("estimators.triad.filter.alpha=0.9",)


def rows(small: Path, out: Path, *settings: str, runs: int | None = None) -> dict[str, Row]:
    """The state of the slow case, by estimator."""
    steps = plan(load_scenario(small, settings), out, Selection(runs, cases=["slow"]))
    return {row.estimator: row for row in overview(find_results(out / "small"), steps)}


def test_all_is_up_to_date(small: Path, reference: Path) -> None:
    found = rows(small, reference)
    assert list(found) == ["", "triad", "wahba"]
    for row in found.values():
        assert (row.there, row.wanted, row.due, row.failed) == (3, 3, (), Counter())
    assert found["triad"].ended == {LIMIT: 3, "filter: consistent": 3}
    assert list(found[""].lines()) == ["small slow, simulation: 3 runs there, 3 wanted, up to date"]


def test_a_change_is_told_as_a_dry_run_tells_it(
    small: Path, reference: Path, sweep: Callable, rewrite: Callable
) -> None:
    row = rows(rewrite(small, *CHANGED), reference)["triad"]
    dry = sweep(small, reference, "--dry-run", "--case", "slow")
    assert list(row.due) == dry.stdout.splitlines()[:-1]
    assert list(row.lines())[:2] == [
        "small slow, triad: 3 runs there, 3 wanted, out of date",
        "  small slow: filter triad, runs 0-2: filter.alpha was 1.0, is 0.9 (and 1 more)",
    ]


def test_more_runs_and_missing_files(small: Path, swept: Path) -> None:
    (swept / "small" / "slow" / "assess-wahba.000000.h5").unlink()
    found = rows(small, swept)
    assert (found["wahba"].there, found["triad"].there) == (0, 3)
    assert "not there yet" in found["wahba"].due[0]
    assert rows(small, swept, runs=25)["triad"].wanted == 25


def test_failed_runs_are_counted_with_their_reason(
    small: Path, tmp_path: Path, sweep: Callable, cli: Callable, break_runs: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    with monkeypatch.context() as patch:
        break_runs(patch, BasisPursuit, "recover", 0, {0, 2})
        assert sweep(small, tmp_path / "out", "--case", "slow").exit_code == 1
    row = rows(small, tmp_path / "out")["wahba"]
    ((reason, runs),) = row.failed.items()
    assert runs == 2
    assert reason.startswith(
        "recover failed: estimators.wahba.recovery (basis_pursuit): Arithmetic"
    )
    assert row.ended == {LIMIT: 1, "filter: consistent": 1}
    told = cli("status", small, "--out", tmp_path / "out", "--case", "slow").stdout
    assert f"  {reason} (2 runs)" in told.splitlines()


def test_diverged_runs_are_counted_in_the_words_of_the_filter(
    small: Path, tmp_path: Path, sweep: Callable, rewrite: Callable
) -> None:
    rewrite(small, "estimators.triad.start.variance.rate_rad2_s2=1e300")
    sweep(small, tmp_path / "out", "--case", "slow")
    ended = rows(small, tmp_path / "out")["triad"].ended
    diverged = [(how, runs) for how, runs in ended.items() if "diverged" in how]
    assert [runs for _, runs in diverged] == [3]


def test_only_what_is_up_to_date_is_kept(small: Path, reference: Path) -> None:
    steps = plan(load_scenario(small, CHANGED), reference, Selection(runs=2, cases=["slow"]))
    results = up_to_date(find_results(reference / "small"), steps)
    assert results.cases == ["slow"]
    assert results.stages("slow", "triad") == ["recover"]
    assert results.stages("slow", "wahba") == ["recover", "filter", "assess"]
    assert results.load("slow", "wahba")["run"].tolist() == [0, 1]


def test_a_stage_with_a_gap_is_not_complete(small: Path, tmp_path: Path, sweep: Callable) -> None:
    some = ("--case", "slow", "--estimator", "triad", "--runs", 22)
    assert sweep(small, tmp_path / "out", *some).exit_code == 0
    (tmp_path / "out" / "small" / "slow" / "filter-triad.000020.h5").unlink()
    steps = plan(load_scenario(small), tmp_path / "out", Selection(22, ["slow"], ["triad"]))
    there = find_results(tmp_path / "out" / "small")
    assert up_to_date(there, steps).runs("slow", "triad", "filter") == 20
    complete = up_to_date(there, steps, complete=True)
    assert complete.stages("slow", "triad") == ["recover"]


def test_the_command_tells_it_and_writes_nothing(
    small: Path, swept: Path, cli: Callable, rewrite: Callable
) -> None:
    rewrite(small, *CHANGED)
    (swept / "small" / "slow" / "notes.h5").write_text("mine")
    before = {path: path.stat().st_mtime_ns for path in swept.rglob("*")}
    done = cli("status", small, "--out", swept)
    assert done.exit_code == 0
    assert "small fast, triad: 3 runs there, 3 wanted, out of date" in done.stdout
    assert "small fast, wahba: 3 runs there, 3 wanted, up to date" in done.stdout
    assert "  filter: consistent (3 runs)" in done.stdout.splitlines()
    assert done.stderr == f"{swept / 'small/slow/notes.h5'} is not a checkpoint of debrisest\n"
    assert {path: path.stat().st_mtime_ns for path in swept.rglob("*")} == before


def test_the_command_before_any_sweep(small: Path, tmp_path: Path, cli: Callable) -> None:
    done = cli("status", small, "--out", tmp_path / "none", "--case", "slow")
    assert (done.exit_code, done.stderr) == (0, "")
    assert "small slow, simulation: 0 runs there, 3 wanted, out of date" in done.stdout
    assert "  small slow: simulate, runs 0-2: not there yet" in done.stdout
    assert cli("status", small, "--case", "slwo").exit_code == 2
