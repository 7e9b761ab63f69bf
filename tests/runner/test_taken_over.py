"""What a variant has in common with another is taken over from there, and nothing else is."""

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from debrisest.runner import taken_over

REDRAWN = ("--set", "estimators.wahba.filter.redraw=false")
NAME = "small@estimators.wahba.filter.redraw=false"
OTHER_TABLES = ("--set", "tables.diverged=[{quantity: rate, above: 1e-3, window: 40-60 s}]")


def tables(out: Path, name: str = NAME) -> bytes:
    return (out / name / "tables.csv").read_bytes()


def ran(told: str) -> list[str]:
    """The steps of a sweep, without their numbers and runs."""
    lines = [line for line in told.splitlines() if line.startswith("[")]
    return [line.partition("] ")[2].partition(", runs")[0].partition(" ")[2] for line in lines]


def same_files(out: Path, name: str = NAME) -> set[str]:
    """The files that are one with those of the plain folder."""
    files = {path.relative_to(out / name) for path in (out / name).rglob("*.h5")}
    plain = out / "small"
    there = {one for one in files if (plain / one).exists()}
    return {str(one) for one in there if os.path.samefile(plain / one, out / name / one)}


@pytest.fixture(scope="module")
def fresh(tmp_path_factory: pytest.TempPathFactory, sweep: Callable) -> Path:
    """The results of the changed scenario where nothing else is."""
    small = Path(__file__).parents[1] / "scenarios" / "small.yaml"
    out = tmp_path_factory.mktemp("fresh")
    assert sweep(small, out, *REDRAWN).exit_code == 0
    return out


def test_only_what_differs_is_computed_and_the_tables_are_the_same(
    small: Path, swept: Path, sweep: Callable, fresh: Path, data_of: Callable, same_data: Callable
) -> None:
    before = tables(swept, "small")
    dry = sweep(small, swept, *REDRAWN, "--dry-run").stdout
    assert dry.endswith("\n4 of 14 steps would run, 10 are the same in another variant\n")
    done = sweep(small, swept, *REDRAWN)
    stages = ("filter wahba", "assess wahba")
    assert sorted(ran(done.stderr)) == sorted(f"{c}: {s}" for c in ("slow", "fast") for s in stages)
    assert tables(swept) == tables(fresh) != before == tables(swept, "small")
    assert len(same_files(swept)) == 10
    there, expected = data_of(swept / NAME), data_of(fresh / NAME)
    assert there.keys() == expected.keys()
    assert all(same_data(there[name], expected[name]) for name in there)
    assert sweep(small, swept, *REDRAWN, "--dry-run").stdout == "0 of 14 steps would run\n"


def test_the_plain_folder_takes_over_from_a_variant(
    small: Path, fresh: Path, tmp_path: Path, sweep: Callable, reference: Path
) -> None:
    out = Path(shutil.copytree(fresh, tmp_path / "out"))
    assert len(ran(sweep(small, out).stderr)) == 4
    assert tables(out, "small") == tables(reference, "small")


def test_killed_at_any_moment(
    small: Path, swept: Path, fresh: Path, process: Callable, sweep: Callable
) -> None:
    for count in (1, 9, 11):
        running: subprocess.Popen = process("sweep", small, "--out", swept, "--jobs", 1, *REDRAWN)
        end = time.monotonic() + 60
        while len(list(swept.glob(f"{NAME}/*/*.h5"))) < count and running.poll() is None:
            assert time.monotonic() < end
        os.killpg(running.pid, signal.SIGKILL)
        running.communicate()
    assert sweep(small, swept, *REDRAWN).exit_code == 0
    assert tables(swept) == tables(fresh)


def test_what_is_damaged_or_has_fewer_runs_is_computed(
    small: Path, swept: Path, tmp_path: Path, sweep: Callable, fresh: Path
) -> None:
    for path in (swept / "small" / "slow").glob("*.h5"):
        path.write_bytes(path.read_bytes()[:-9])
    done = sweep(small, swept, *REDRAWN)
    assert (done.exit_code, len(ran(done.stderr))) == (0, 9)
    assert tables(swept) == tables(fresh)
    out = tmp_path / "out"
    sweep(small, out, "--runs", 1)
    assert len(ran(sweep(small, out, *REDRAWN).stderr)) == 14
    assert tables(out) == tables(fresh)


def test_more_runs_are_computed_and_what_was_taken_over_stays(
    small: Path, swept: Path, tmp_path: Path, sweep: Callable
) -> None:
    sweep(small, swept, *REDRAWN)
    before = tables(swept, "small")
    assert len(ran(sweep(small, swept, *REDRAWN, "--runs", 4).stderr)) == 14
    sweep(small, tmp_path / "out", *REDRAWN, "--runs", 4)
    assert tables(swept) == tables(tmp_path / "out")
    assert sweep(small, swept, "--dry-run").stdout == "0 of 14 steps would run\n"
    sweep(small, swept)
    assert tables(swept, "small") == before


def test_force_computes_all(small: Path, swept: Path, sweep: Callable) -> None:
    assert len(ran(sweep(small, swept, *REDRAWN, "--force").stderr)) == 14
    assert same_files(swept) == set()


def test_a_disk_without_links_has_copies(
    small: Path, swept: Path, sweep: Callable, fresh: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(taken_over.os, "link", refuse)
    assert len(ran(sweep(small, swept, *REDRAWN).stderr)) == 4
    assert tables(swept) == tables(fresh)
    assert same_files(swept) == set()


def test_other_tables_are_not_taken_over_with_the_errors(
    small: Path, swept: Path, sweep: Callable, cli: Callable
) -> None:
    """A comparison reads the tables from the files of errors."""
    done = sweep(small, swept, *OTHER_TABLES, "--variant", "strict")
    assert not [name for name in ran(done.stderr) if "simulate" in name or "recover" in name]
    told = cli("compare", swept / "small", swept / "small@strict").stdout
    assert "tables.diverged.0.above: 90 -> 0.001" in told


def test_other_data_are_simulated(small: Path, swept: Path, sweep: Callable) -> None:
    assert len(ran(sweep(small, swept, "--set", "seed=8").stderr)) == 14


def test_trajectories_that_the_errors_need_are_computed(
    small: Path, swept: Path, sweep: Callable, tmp_path: Path
) -> None:
    """The other folder has the trajectories of one run only, from which no errors can be made."""
    changed = ("--set", "tables.scored_window=30-60 s")
    done = sweep(small, swept, *changed)
    assert {name.partition(": ")[2] for name in ran(done.stderr)} >= {"filter wahba"}
    sweep(small, tmp_path / "out", *changed)
    name = "small@tables.scored_window=30-60s"
    found = [path.name for path in swept.glob("small@*")]
    assert len(found) == 1
    assert np.all(tables(swept, found[0]) == tables(tmp_path / "out", found[0])), name
