"""Killed, interrupted, damaged, extended or changed: the tables come out the same."""

import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest


def tables(out: Path) -> bytes:
    return (out / "small" / "tables.csv").read_bytes()


def files(out: Path) -> set[str]:
    return {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}


def states(out: Path) -> dict[str, tuple[int, int]]:
    """Return what changes when a file is written again."""
    found = {path: path.stat() for path in out.rglob("*.h5")}
    return {str(p.relative_to(out)): (s.st_ino, s.st_mtime_ns) for p, s in found.items()}


def wait_for_files(running: subprocess.Popen, out: Path, count: int) -> None:
    end = time.monotonic() + 60
    while len(list(out.rglob("*.h5"))) < count and running.poll() is None:
        assert time.monotonic() < end
        time.sleep(0.005)


def ran(result: Any) -> list[str]:
    """Return the steps that a command told to have run, without their numbers."""
    return re.findall(r"^\[\d+/\d+\] small (.*), runs", result.stderr, re.M)


# killed


def test_killed_at_several_moments(
    small: Path, tmp_path: Path, reference: Path, process: Callable, sweep: Callable
) -> None:
    out = tmp_path / "out"
    for count in (1, 8):
        running = process("sweep", small, "--out", out, "--jobs", 2)
        wait_for_files(running, out, count)
        os.killpg(running.pid, signal.SIGKILL)
        running.communicate()
        done = len(list(out.rglob("*.h5")))
        assert count <= done
    result = sweep(small, out)
    assert result.exit_code == 0, result.stderr
    assert len(ran(result)) == 14 - done
    assert tables(out) == tables(reference)
    # what a killed process was writing stays until nothing of that process is left
    assert {name for name in files(out) if not name.endswith(".tmp")} == files(reference)


def test_a_killed_worker_is_told_in_words(small: Path, tmp_path: Path, process: Callable) -> None:
    out = tmp_path / "out"
    running = process("sweep", small, "--out", out, "--jobs", 2, "--runs", 60)
    wait_for_files(running, out, 1)
    workers = subprocess.run(
        ["pgrep", "-P", str(running.pid), "-f", "spawn_main"], capture_output=True, text=True
    ).stdout.split()
    os.kill(int(workers[-1]), signal.SIGKILL)
    _, told = running.communicate(timeout=60)
    assert running.returncode == 1, told
    assert "Traceback" not in told


@pytest.mark.parametrize("moment", ["running", "tables"])
def test_no_half_written_table_replaces_a_table(
    moment: str, swept: Path, small: Path, sweep: Callable, rewrite: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    from debrisest.results import store
    from debrisest.show.tables import cells

    def fail(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    if moment == "running":
        monkeypatch.setattr(store, "write", fail)
    else:
        monkeypatch.setattr(cells.pd.DataFrame, "to_csv", fail)
    before = {path: path.read_bytes() for path in swept.rglob("tables.*")}
    result = sweep(rewrite(small, "seed=8"), swept)
    assert result.exit_code == 130 or moment == "tables"
    assert {path: path.read_bytes() for path in swept.rglob("tables.*")} == before


# interrupted


def test_ctrl_c_in_process(
    small: Path, tmp_path: Path, reference: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    from debrisest.results import store

    original, written = store.write, []

    def interrupted(path: Path, *rest: Any) -> None:
        if len(written) == 6:
            raise KeyboardInterrupt
        written.append(path)
        original(path, *rest)

    with monkeypatch.context() as patch:
        patch.setattr(store, "write", interrupted)
        result = sweep(small, tmp_path / "out")
    assert result.exit_code == 130
    assert "interrupted: finished steps are kept" in result.stderr
    assert all(path.exists() for path in written)
    again = sweep(small, tmp_path / "out")
    assert "[1/8]" in again.stderr
    assert tables(tmp_path / "out") == tables(reference)


@pytest.mark.parametrize("moment", ["running", "starting"])
def test_ctrl_c_of_the_whole_group(
    moment: str, small: Path, tmp_path: Path, process: Callable
) -> None:
    """What a terminal does: every process of the group gets the signal."""
    out = tmp_path / "out"
    running = process("sweep", small, "--out", out, "--jobs", 2, "--runs", 60)
    if moment == "running":
        wait_for_files(running, out, 2)
    else:
        while not subprocess.run(
            ["pgrep", "-P", str(running.pid), "-f", "spawn_main"], capture_output=True
        ).stdout:
            time.sleep(0.01)
        time.sleep(0.2)
    os.killpg(running.pid, signal.SIGINT)
    shown, told = running.communicate(timeout=60)
    assert running.returncode == 130, told
    assert "interrupted: finished steps are kept, the same command goes on from there" in told
    assert "Traceback" not in told + shown
    assert "SpawnProcess" not in told + shown
    assert len(list(out.rglob("*.h5"))) >= 2 * (moment == "running")
    assert not (out / "small" / "tables.csv").exists()


# jobs, order, deleted files


def test_two_processes_give_the_same_tables_as_one(
    small: Path, tmp_path: Path, reference: Path, process: Callable, data_of: Callable,
    same_data: Callable,
) -> None:  # fmt: skip
    running = process("sweep", small, "--out", tmp_path / "out", "--jobs", 2)
    shown, told = running.communicate()
    assert running.returncode == 0, told
    assert "Table 1" in shown
    assert tables(tmp_path / "out") == tables(reference)
    one, two = data_of(reference), data_of(tmp_path / "out")
    assert one.keys() == two.keys()
    assert all(same_data(one[name], two[name]) for name in one)


def test_nothing_to_do(swept: Path, small: Path, reference: Path, sweep: Callable) -> None:
    before = states(swept)
    result = sweep(small, swept)
    assert result.exit_code == 0
    assert ran(result) == []
    assert states(swept) == before
    assert tables(swept) == tables(reference)


def test_any_deleted_file_comes_back(
    swept: Path, small: Path, reference: Path, sweep: Callable, data_of: Callable,
    same_data: Callable,
) -> None:  # fmt: skip
    complete = data_of(reference)
    for name in sorted(complete):
        if "slow" in name and "wahba" not in name:
            (swept / name).unlink()
            (swept / "small" / "tables.csv").unlink()
            assert sweep(small, swept, "--quiet").exit_code == 0
            assert tables(swept) == tables(reference)
    again = data_of(swept)
    assert all(same_data(complete[name], again[name]) for name in complete)


def test_a_deleted_result_is_the_only_step_that_runs(
    swept: Path, small: Path, sweep: Callable
) -> None:
    (swept / "small" / "fast" / "assess-triad.000000.h5").unlink()
    assert ran(sweep(small, swept)) == ["fast: assess triad"]


def reversed_cases(small: Path, tmp_path: Path) -> Path:
    text = small.read_text()
    slow = re.search(r"^  slow: .*\n", text, re.M)[0]
    other = tmp_path / "reversed" / "small.yaml"
    other.parent.mkdir()
    other.write_text(text.replace(slow, "") + slow)
    shutil.copy(small.with_name("small.csv"), other.parent)
    return other


def test_nothing_depends_on_the_order_of_the_cases(
    small: Path, tmp_path: Path, reference: Path, sweep: Callable, data_of: Callable,
    same_data: Callable,
) -> None:  # fmt: skip
    config = reversed_cases(small, tmp_path)
    assert sweep(config, tmp_path / "out").exit_code == 0
    one, two = data_of(reference), data_of(tmp_path / "out")
    assert one.keys() == two.keys()
    assert all(same_data(one[name], two[name]) for name in one)
    assert sorted(tables(tmp_path / "out").split(b"\n")) == sorted(tables(reference).split(b"\n"))


def test_results_serve_whatever_the_order_of_the_cases(
    small: Path, tmp_path: Path, swept: Path, sweep: Callable
) -> None:
    assert ran(sweep(reversed_cases(small, tmp_path), swept, "--dry-run")) == []


def test_simulations_do_not_depend_on_the_estimators(
    small: Path, tmp_path: Path, reference: Path, cli: Callable, data_of: Callable,
    same_data: Callable,
) -> None:  # fmt: skip
    text = small.read_text()
    start, end = text.index("  triad:\n"), text.index("  wahba:\n")
    anchors = text[start:end].replace("  triad:", "  other:")
    other = text[:start] + anchors + text[end:].replace(", wahba", "")
    small.write_text(other.replace("  published: small.csv\n", ""))
    result = cli("simulate", small, "--out", tmp_path / "out", "--case", "slow", "--jobs", 1)
    assert result.exit_code == 0, result.stderr
    name = "small/slow/simulate.000000.h5"
    assert same_data(data_of(tmp_path / "out")[name], data_of(reference, "simulate*")[name])


def test_cases_draw_different_noise(reference: Path, data_of: Callable) -> None:
    data = data_of(reference, "simulate*")
    slow, fast = (data[f"small/{case}/simulate.000000.h5"] for case in ("slow", "fast"))
    assert (slow["true_position"] == fast["true_position"]).all()
    assert not (slow["measured_point"][0] == slow["measured_point"][1]).any()
    assert not (slow["measured_point"] == fast["measured_point"]).any()


# more runs, fewer runs


def test_more_runs_extend_and_fewer_delete_nothing(
    small: Path, tmp_path: Path, reference: Path, cli: Callable, data_of: Callable,
    same_data: Callable,
) -> None:  # fmt: skip
    out, some = tmp_path / "out", ("--case", "slow", "--out", tmp_path / "out", "--jobs", 1)
    assert cli("recover", small, *some, "--runs", 2).exit_code == 0
    dry = cli("recover", small, *some, "--runs", 22, "--dry-run")
    assert "simulate, runs 0-19: holds 2 runs, 20 are wanted" in dry.stdout
    assert "simulate, runs 20-21: not there yet" in dry.stdout
    assert cli("recover", small, *some, "--runs", 22).exit_code == 0
    after = states(out)
    assert {name.split(".")[1] for name in after} == {"000000", "000020"}
    data, short = data_of(out), data_of(reference)
    for stage in ("simulate", "recover-triad", "recover-wahba"):
        long, first = data[f"small/slow/{stage}.000000.h5"], short[f"small/slow/{stage}.000000.h5"]
        per_run = {k: v[:3] if v.shape[:1] == (20,) else v for k, v in long.items()}
        assert same_data(per_run, first)
    assert data["small/slow/simulate.000020.h5"]["run"].tolist() == [20, 21]
    assert ran(cli("recover", small, *some, "--runs", 3)) == []
    assert states(out) == after


def test_fewer_runs_give_the_tables_of_a_direct_sweep(
    swept: Path, small: Path, tmp_path: Path, sweep: Callable
) -> None:
    before = states(swept)
    assert ran(sweep(small, swept, "--runs", 2)) == []
    assert states(swept) == before
    assert sweep(small, tmp_path / "direct", "--runs", 2).exit_code == 0
    assert tables(swept) == tables(tmp_path / "direct")


# changes


FILTER = "estimators.triad.filter.alpha=0.9"


def test_a_filter_parameter_runs_filter_and_assess_again(
    swept: Path, small: Path, sweep: Callable, rewrite: Callable
) -> None:
    before, content, text = states(swept), tables(swept), small.read_text()
    dry = sweep(rewrite(small, FILTER), swept, "--dry-run")
    assert dry.exit_code == 0
    assert dry.stdout.splitlines() == [
        "small slow: filter triad, runs 0-2: filter.alpha was 1.0, is 0.9",
        "small slow: assess triad, runs 0-2: filter runs before it",
        "small fast: filter triad, runs 0-2: filter.alpha was 1.0, is 0.9",
        "small fast: assess triad, runs 0-2: filter runs before it",
        "4 of 14 steps would run",
    ]
    assert (states(swept), tables(swept)) == (before, content)
    result = sweep(small, swept)
    assert ran(result) == [
        f"{case}: {stage} triad" for case in ("slow", "fast") for stage in ("filter", "assess")
    ]
    changed = {name for name, state in states(swept).items() if state != before[name]}
    assert len(changed) == 4
    assert all("filter-triad" in name or "assess-triad" in name for name in changed)
    assert tables(swept) != content
    small.write_text(text)
    assert len(ran(sweep(small, swept))) == 4
    assert tables(swept) == content


CHANGES = {
    "noise": ("sensors.points.noise_m=0.02", 14, "sensors.points.noise_m was 0.01, is 0.02"),
    "seed": ("seed=8", 14, "seed was 7, is 8"),
    "duration": ("duration_s=70", 14, "duration_s was 60.0, is 70.0"),
    "recovery": ("estimators.wahba.recovery.penalty=0.4", 6, "recovery.penalty was 0.3, is 0.4"),
    "problem": ("estimators.wahba.problem.measurement_noise=1e-3", 4, "was 0.0001, is 0.001"),
    "scored_window": ("tables.scored_window=30-60 s", 4, "scored.0 was 40.0, is 30.0"),
    "runs": ("runs=4", 14, "holds 3 runs, 4 are wanted"),
    "title": ("title=another", 0, "0 of 14"),
    "limit": ("tables.diverged=[]", 0, "0 of 14"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_runs_what_depends_on_it(
    name: str, swept: Path, small: Path, sweep: Callable, rewrite: Callable
) -> None:
    setting, steps, reason = CHANGES[name]
    dry = sweep(rewrite(small, setting), swept, "--dry-run")
    assert dry.stdout.splitlines()[-1] == f"{steps} of 14 steps would run"
    assert reason in dry.stdout


def test_the_order_of_the_features_is_part_of_the_scenario(
    swept: Path, small: Path, sweep: Callable
) -> None:
    """The first three features define the frame that the estimators know."""
    text = small.read_text()
    first, second = (re.search(rf"^    {name}: .*\n", text, re.M)[0] for name in "ab")
    small.write_text(text.replace(first + second, second + first))
    dry = sweep(small, swept, "--dry-run")
    assert dry.stdout.splitlines()[-1] == "14 of 14 steps would run"


def test_a_dry_run_writes_nothing(small: Path, tmp_path: Path, sweep: Callable) -> None:
    result = sweep(small, tmp_path / "out", "--dry-run")
    assert result.exit_code == 0
    assert result.stdout.splitlines()[-1] == "14 of 14 steps would run"
    assert "small slow: simulate, runs 0-2: not there yet" in result.stdout
    assert not (tmp_path / "out").exists()


def test_force_runs_everything_again(
    swept: Path, small: Path, reference: Path, sweep: Callable
) -> None:
    before = states(swept)
    dry = sweep(small, swept, "--force", "--dry-run")
    assert "small slow: simulate, runs 0-2: asked for by --force" in dry.stdout
    result = sweep(small, swept, "--force")
    assert len(ran(result)) == 14
    assert not set(states(swept).items()) & set(before.items())
    assert tables(swept) == tables(reference)


def test_force_with_fewer_runs_deletes_no_run(
    swept: Path, small: Path, sweep: Callable, data_of: Callable
) -> None:
    sweep(small, swept, "--force", "--runs", 1, "--case", "slow", "--estimator", "triad")
    assert len(data_of(swept)["small/slow/simulate.000000.h5"]["run"]) == 3


def test_one_case_and_one_estimator(small: Path, tmp_path: Path, sweep: Callable) -> None:
    result = sweep(small, tmp_path, "--case", "slow", "--estimator", "wahba", "--runs", 1)
    assert ran(result) == [
        "slow: simulate", "slow: recover wahba", "slow: filter wahba", "slow: assess wahba",
    ]  # fmt: skip


def test_stages_bring_what_they_need(small: Path, tmp_path: Path, cli: Callable) -> None:
    some = ("--case", "slow", "--estimator", "wahba", "--runs", 1, "--jobs", 1, "--out", tmp_path)
    told = [ran(cli(command, small, *some)) for command in ("simulate", "recover", "filter")]
    assert told == [
        ["slow: simulate"], ["slow: recover wahba"], ["slow: filter wahba", "slow: assess wahba"],
    ]  # fmt: skip


def test_quiet_tells_no_progress(small: Path, tmp_path: Path, cli: Callable) -> None:
    result = cli("simulate", small, "--out", tmp_path, "--jobs", 1, "--quiet")
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")
