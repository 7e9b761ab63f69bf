"""A bad run is counted and named, and never takes the others down."""

import math
from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from debrisest.parts.recoveries.basis_pursuit import BasisPursuit
from debrisest.parts.sensors.feature_points import FeaturePoints
from debrisest.parts.starts.first_samples import FirstSamples
from debrisest.problems.tumbling.attitude import TumblingAttitude
from debrisest.results import store
from debrisest.runner.compute import _attributes
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.stages import assess
from debrisest.scenario.load import load_scenario

ONE = ("--case", "slow", "--estimator", "triad")


def cells(out: Path) -> pd.DataFrame:
    return pd.read_csv(StringIO((out / "small" / "tables.csv").read_text()))


def break_runs(
    monkeypatch: pytest.MonkeyPatch, part: type, method: str, bad: set[int], where: int = 1
) -> None:
    """Let a method raise whenever one of the bad runs is among those it is given."""
    original = getattr(part, method)

    def broken(self: Any, *arguments: Any) -> Any:
        given = arguments[where]
        runs = given.runs if hasattr(given, "runs") else given["run"].astype(int).tolist()
        if bad & set(runs):
            raise ArithmeticError("the tank is empty")
        return original(self, *arguments)

    monkeypatch.setattr(part, method, broken)


UNFORESEEN = (
    "ArithmeticError: the tank is empty; this is a mistake of debrisest or of a plug-in: "
    "please report it"
)
STAGES = {
    "recover": (BasisPursuit, "recover", 0),
    "filter": (FirstSamples, "start", 0),
    "assess": (TumblingAttitude, "assess", 0),
}


@pytest.mark.parametrize("stage", STAGES)
def test_a_failed_run_is_counted_and_named(
    stage: str, small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch,
    reference: Path, data_of: Callable,
) -> None:  # fmt: skip
    part, method, where = STAGES[stage]
    break_runs(monkeypatch, part, method, {1}, where)
    out = tmp_path / "out"
    result = sweep(small, out, *ONE)
    assert result.exit_code == 1
    told = f"small slow: {stage} triad, run 1 failed: estimators.triad."
    (line,) = (line for line in result.stderr.splitlines() if "failed" in line)
    assert line.startswith(told) and line.endswith(UNFORESEEN)
    rows = cells(out)
    assert len(rows) == 6
    assert (rows["runs"] == 3).all()
    assert (rows["failed"] == 1).all()
    assert (rows["diverged"] == 0).all()
    good, complete = data_of(out), data_of(reference)
    for name, data in good.items():
        for key, values in data.items():
            expected = complete[name][key]
            if values.dtype.kind == "f" and len(values) == 3:
                assert np.array_equal(values[[0, 2]], expected[[0, 2]], equal_nan=True), key
        assert data["run"].tolist() == [0, 1, 2]
    failed = good[f"small/slow/{stage}-triad.000000.h5"]
    assert failed["failure"][[0, 2]].tolist() == ["", ""]
    assert failed["failure"][1].endswith(UNFORESEEN)


def test_a_run_that_cannot_be_simulated(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    break_runs(monkeypatch, FeaturePoints, "simulate", {2}, 2)
    result = sweep(small, tmp_path / "out", *ONE)
    assert result.exit_code == 1
    assert "simulate, run 2 failed: sensors.points (feature_points): Arithmetic" in result.stderr
    assert (cells(tmp_path / "out")["failed"] == 1).all()


def test_a_failure_is_told_again_as_long_as_it_is_there(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        break_runs(patch, BasisPursuit, "recover", {1}, 0)
        assert sweep(small, tmp_path / "out", *ONE).exit_code == 1
    again = sweep(small, tmp_path / "out", *ONE)
    assert again.exit_code == 1
    assert "recover triad, run 1 failed" in again.stderr
    assert sweep(small, tmp_path / "out", *ONE, "--force").exit_code == 0


@pytest.mark.parametrize("stage", ["recover", "filter", "assess"])
def test_a_whole_chunk_that_fails_leaves_the_others(
    stage: str, small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    part, method, where = STAGES[stage]
    break_runs(monkeypatch, part, method, set(range(20)), where)
    result = sweep(small, tmp_path / "out", *ONE, "--runs", 22)
    assert result.exit_code == 1
    assert sum("tank is empty" in line for line in result.stderr.splitlines()) == 20
    rows = cells(tmp_path / "out")
    assert (rows["runs"] == 22).all()
    assert (rows["failed"] == 20).all()
    assert rows["measured"].notna().all()
    assert (rows["verdict"].isin(["not reproduced", "unpublished"])).all()


def test_a_whole_chunk_that_cannot_be_simulated(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    break_runs(monkeypatch, FeaturePoints, "simulate", set(range(20)), 2)
    result = sweep(small, tmp_path / "out", *ONE, "--runs", 22)
    assert result.exit_code == 1
    assert sum("tank is empty" in line for line in result.stderr.splitlines()) == 20
    assert (cells(tmp_path / "out")["failed"] == 20).all()


def test_when_every_run_fails_the_cells_say_so(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    break_runs(monkeypatch, BasisPursuit, "recover", {0, 1, 2}, 0)
    result = sweep(small, tmp_path / "out", *ONE)
    assert result.exit_code == 1
    rows = cells(tmp_path / "out")
    assert len(rows) == 6
    assert (rows["failed"] == 3).all()
    assert rows["measured"].isna().all()
    assert rows["verdict"].iloc[0] == "not reproduced"


def test_a_check_misses_the_cells_that_are_not_there(
    small: Path, swept: Path, cli: Callable
) -> None:
    (swept / "small" / "slow" / "assess-triad.000000.h5").unlink()
    assert cli("table", small, "--out", swept, "--check").exit_code == 1


@pytest.mark.parametrize(
    ("compute", "told"),
    [
        (lambda: np.exp(np.full(3, 1e3)), "overflow encountered in exp"),
        (lambda: np.zeros(2) / np.zeros(2), "invalid value encountered in divide"),
        (lambda: np.linalg.inv(np.zeros((2, 2))), "singular matrix"),
        (lambda: math.exp(1e6), "math range error"),
    ],
)
def test_numbers_that_do_not_work_out_are_told_with_part_and_keys(
    compute: Callable, told: str, small: Path, tmp_path: Path, sweep: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr(FirstSamples, "start", lambda *_: compute())
    result = sweep(small, tmp_path / "out", *ONE)
    assert result.exit_code == 1
    (line,) = (line for line in result.stderr.splitlines() if "run 1 failed" in line)
    assert "estimators.triad.start (first_samples) with samples: 5, variance: " in line
    assert f"its numbers do not work out ({told}); a value is too large or too small" in line
    assert "Error:" not in line


def test_too_little_memory_is_told_with_part_and_keys(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(FirstSamples, "start", lambda *_: np.zeros((2**50, 2)))
    result = sweep(small, tmp_path / "out", *ONE)
    assert result.exit_code == 1
    (line,) = (line for line in result.stderr.splitlines() if "not enough memory" in line)
    assert "estimators.triad.start (first_samples) with samples: 5, variance: " in line
    assert not list((tmp_path / "out").rglob("filter*"))


def no_room(*_: Any, **__: Any) -> None:
    raise OSError(28, "No space left on device")


def test_a_file_that_cannot_be_written(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "write", no_room)
    result = sweep(small, tmp_path / "out", *ONE)
    assert result.exit_code == 1
    assert "simulate, runs 0-2 failed: No space left on device; the same" in result.stderr


def test_a_library_that_cannot_be_loaded_fails_no_run(
    small: Path, tmp_path: Path, reference: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_map(*_: Any) -> None:
        raise ImportError("scipy/x.so: failed to map segment from shared object")

    with monkeypatch.context() as patch:
        patch.setattr(assess, "silent_failures", no_map)
        result = sweep(small, tmp_path, *ONE)
    assert result.exit_code == 1
    assert "a library could not be loaded: scipy/x.so: failed to map" in result.stderr
    assert not list(tmp_path.rglob("assess*.h5"))
    assert sweep(small, tmp_path).exit_code == 0
    tables = [(out / "small" / "tables.csv").read_bytes() for out in (tmp_path, reference)]
    assert tables[0] == tables[1]


def test_an_old_file_does_not_hide_a_step_that_failed(
    small: Path, swept: Path, sweep: Callable, rewrite: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "write", no_room)
    assert sweep(rewrite(small, "seed=8"), swept, *ONE).exit_code == 1


def test_a_damaged_file_that_cannot_be_replaced(
    small: Path, swept: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = swept / "small" / "slow" / "assess-triad.000000.h5"
    path.write_bytes(path.read_bytes()[:9000])
    monkeypatch.setattr(store, "write", no_room)
    assert sweep(small, swept, *ONE).exit_code == 1


def test_a_diverged_run_is_a_value(
    swept: Path, small: Path, reference: Path, sweep: Callable, data_of: Callable,
    rewrite: Callable,
) -> None:  # fmt: skip
    """A limit between the runs' errors makes those above it diverge, and leaves the others."""
    data = data_of(reference, "assess-triad*")["small/fast/assess-triad.000000.h5"]
    rms = np.degrees(np.sqrt(np.mean(data["rate"][:, 40:] ** 2, axis=1)))
    limit = float(np.sort(rms)[1:].mean())
    setting = f"tables.diverged=[{{quantity: rate, above: {limit}, window: 40-60 s}}]"
    result = sweep(rewrite(small, setting), swept)
    assert result.exit_code == 0
    rows = cells(swept)
    mine = rows[(rows["case"] == "fast") & (rows["estimator"] == "triad")]
    after = mine[mine["table"] != "1"]
    assert (mine[mine["table"] == "1"]["diverged"] == 0).all()
    assert (after["diverged"] == 1).all()
    assert (after["failed"] == 0).all()
    rate = after[(after["quantity"] == "rate_1") & (after["window"] == "40-60 s")]["measured"]
    kept = np.degrees(np.sqrt(np.mean(data["rate_1"][rms <= limit][:, 40:] ** 2, axis=1))).mean()
    assert rate.item() == pytest.approx(kept, rel=1e-5)


def test_an_estimate_that_is_not_finite_is_a_value(
    small: Path, tmp_path: Path, sweep: Callable, rewrite: Callable
) -> None:
    setting = "estimators.triad.start.variance.rate_rad2_s2=1e300"
    result = sweep(rewrite(small, setting), tmp_path / "out", *ONE)
    assert result.exit_code == 0, result.stderr
    rows = cells(tmp_path / "out")
    after = rows[rows["table"] == "2"]
    assert (after["diverged"] == 3).all()
    assert after["measured"].isna().all()
    assert (rows[rows["table"] == "1"]["diverged"] == 0).all()


# a file without truth


@pytest.fixture
def measured(small: Path, reference: Path, tmp_path: Path) -> Path:
    """Results that hold nothing but a simulate file of the slow case, without truth."""
    out = tmp_path / "measured"
    step = plan(load_scenario(small), out, Selection(cases=["slow"]))[0]
    data = store.read(reference / "small" / "slow" / "simulate.000000.h5")
    kept = {name: values for name, values in data.items() if not name.startswith("true_")}
    assert len(kept) < len(data)
    store.write(step.path, kept, _attributes(step))
    return out


def test_a_file_without_truth_passes_through_all_stages(
    measured: Path, small: Path, sweep: Callable, reference: Path, data_of: Callable,
    same_data: Callable,
) -> None:  # fmt: skip
    result = sweep(small, measured, "--case", "slow")
    assert result.exit_code == 0, result.stderr
    assert "simulate" not in result.stderr
    data, complete = data_of(measured), data_of(reference)
    for estimator in ("triad", "wahba"):
        for stage in ("recover", "filter"):
            name = f"small/slow/{stage}-{estimator}.000000.h5"
            assert same_data(data[name], complete[name])
        assessed = data[f"small/slow/assess-{estimator}.000000.h5"]
        assert {"nis", "coverage", "pieces"} <= assessed.keys()
        assert not {"pitch", "rate", "recovered_pitch", "signs_right"} & assessed.keys()
        assert (assessed["failure"] == "").all()


def test_tables_without_truth_show_what_is_left(
    measured: Path, small: Path, sweep: Callable, reference: Path
) -> None:
    sweep(small, measured, "--case", "slow")
    rows, complete = cells(measured), cells(reference)
    assert set(rows["quantity"]) == {"nis"}
    expected = complete[(complete["quantity"] == "nis") & (complete["case"] == "slow")]
    assert rows["measured"].tolist() == expected["measured"].tolist()


def test_nothing_is_simulated_over_measurements(
    measured: Path, small: Path, sweep: Callable
) -> None:
    before = {path: path.read_bytes() for path in measured.rglob("simulate*")}
    sweep(small, measured, "--case", "slow")
    assert {path: path.read_bytes() for path in measured.rglob("simulate*")} == before


def test_of_very_many_failures_the_first_are_told(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    failures = {f"small slow: simulate, run {run}": "no room" for run in range(300)}
    monkeypatch.setattr(
        "debrisest.runner.sweep.bring_up_to_date", lambda *_: {**failures}, raising=True
    )
    done = sweep(small, tmp_path / "out", *ONE)
    told = [line for line in done.stderr.splitlines() if "simulate, run" in line]
    assert (done.exit_code, len(told)) == (1, 20)
    assert "and 280 more failed; debrisest status tells all" in done.stderr
