"""Two results beside each other: settings first, then differences of pairs of runs."""

import csv
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from debrisest.assessment.statistics import per_run, window_mask
from debrisest.results import store


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory, sweep: Callable) -> dict[str, Path]:
    """The small scenario as it is, with another filter, with other draws, and with more noise."""
    config = Path(__file__).parents[2] / "scenarios" / "small.yaml"
    changes = {
        "plain": [],
        "redrawn": ["--set", "estimators.wahba.filter.redraw=false"],
        "seed": ["--set", "seed=8"],
        "noise": ["--set", "sensors.points.noise_m=0.011"],
    }
    found = {}
    for name, options in changes.items():
        out = tmp_path_factory.mktemp(name)
        assert sweep(config, out, "--runs", 8, *options).exit_code == 0
        (found[name],) = out.glob("small*")
    return found


def rows_of(cli: Callable, *arguments: object) -> list[dict[str, str]]:
    done = cli("compare", *arguments, "--format", "csv")
    assert done.exit_code == 0, done.output
    return list(csv.DictReader(io.StringIO(done.stdout)))


def cell(rows: list[dict[str, str]], **wanted: str) -> dict[str, str]:
    (found,) = [row for row in rows if all(row[key] == value for key, value in wanted.items())]
    return found


def test_what_differs_comes_first_and_nothing_else_is_told(results, cli) -> None:
    done = cli("compare", results["plain"], results["redrawn"])
    head = done.stdout.partition("\nTable")[0].splitlines()
    assert [line for line in head if line.startswith("  ")] == [
        "  estimators.wahba.filter.redraw: True -> False"
    ]
    same = cli("compare", results["plain"], results["plain"]).stdout
    assert "\n  nothing\n" in same
    assert "lower" not in same and "higher" not in same


def test_a_difference_is_that_of_the_runs_of_one_number(results, cli) -> None:
    rows = rows_of(cli, results["plain"], results["redrawn"], "--estimator", "wahba")
    found = cell(rows, table="2", case="slow", quantity="pitch", window="40-60 s")
    figures = []
    for name in ("plain", "redrawn"):
        data = store.read(results[name] / "slow" / "assess-wahba.000000.h5")
        inside = window_mask(data["time_s"], (40.0, 60.0))
        figures.append(np.degrees(per_run("rmse", data["pitch"], inside)))
    assert float(found["difference"]) == pytest.approx(np.mean(figures[1] - figures[0]))
    assert float(found["ci_low"]) <= float(found["difference"]) <= float(found["ci_high"])
    spread = np.ptp(figures[1] - figures[0])
    assert float(found["ci_high"]) - float(found["ci_low"]) <= spread
    assert found["pairing"] == "paired: the same data"
    assert found["runs"] == "8"


def test_another_estimator_is_left_as_it_was(results, cli) -> None:
    rows = rows_of(cli, results["plain"], results["redrawn"], "--estimator", "triad")
    assert {row["said"] for row in rows} == {"equal"}
    assert {float(row["difference"]) for row in rows} == {0.0}


def test_other_draws_are_not_paired(results, cli) -> None:
    rows = rows_of(cli, results["plain"], results["seed"])
    assert {row["pairing"] for row in rows} == {"unpaired: other draws"}
    assert all(row["ci_low"] == row["unpaired_low"] for row in rows)
    told = cli("compare", results["plain"], results["seed"]).stdout
    assert "  seed: 7 -> 8\n" in told
    assert "unpaired: other draws" in told


def test_draws_that_are_scaled_are_paired_and_told(results, cli) -> None:
    rows = rows_of(cli, results["plain"], results["noise"], "--estimator", "wahba")
    assert {row["pairing"] for row in rows} == {"paired: the same draws of other data"}
    pitch = cell(rows, table="1", case="mean", quantity="pitch")
    paired, apart = (
        float(pitch[f"{name}_high"]) - float(pitch[f"{name}_low"]) for name in ("ci", "unpaired")
    )
    assert paired < apart / 3


def test_two_estimators_of_one_folder(results, cli) -> None:
    options = (results["plain"], "--estimator", "triad", "--estimator", "wahba")
    rows = rows_of(cli, *options)
    assert {(row["first_estimator"], row["second_estimator"]) for row in rows} == {
        ("triad", "wahba")
    }
    assert "triad -> wahba: recovery.attitude: triad -> wahba" in cli("compare", *options).stdout
    back = rows_of(cli, results["plain"], "--estimator", "wahba", "--estimator", "triad")
    for row, other in zip(rows, back):
        assert float(row["difference"]) == pytest.approx(-float(other["difference"]))


def test_few_runs_show_no_difference(results, cli, reference: Path) -> None:
    rows = rows_of(cli, reference / "small", results["noise"])
    assert {row["said"] for row in rows if row["case"] == "slow"} == {"too few runs"}


def test_wrong_input_is_told(results, cli, tmp_path: Path) -> None:
    for arguments, told in (
        ([results["plain"]], "give two folders of results, or one folder and two estimators"),
        ([results["plain"], tmp_path], "no results of a scenario there"),
        ([results["plain"], results["seed"], "--estimator", "waba"], "did you mean wahba?"),
        ([results["plain"], results["seed"], "--case", "slwo"], "did you mean slow?"),
    ):
        done = cli("compare", *arguments)
        assert done.exit_code == 2
        assert told in done.stderr


def test_files_of_different_settings_are_not_mixed(
    results, cli, small: Path, tmp_path: Path, sweep, rewrite
) -> None:
    setting = ("--case", "slow", "--estimator", "wahba")
    assert sweep(small, tmp_path, "--runs", 21, *setting).exit_code == 0
    rewrite(small, "estimators.wahba.filter.redraw=false")
    assert sweep(small, tmp_path, *setting, "--runs", 1).exit_code == 0
    done = cli("compare", tmp_path / "small", results["plain"])
    assert done.exit_code == 2
    assert "are of different settings" in done.stderr
