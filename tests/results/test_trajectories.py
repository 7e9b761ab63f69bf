"""Which trajectories are kept, and that all that is shown of the others is as if they were."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from debrisest.results import store, trajectories
from debrisest.results.image import as_stored, opened
from debrisest.results.open import open_results
from debrisest.results.trajectories import is_trajectory
from debrisest.results.written import image_of
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.scenario.load import load_scenario
from debrisest.vocabulary import VOCABULARY


@pytest.fixture
def never_small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trajectories, "_SMALL", 0)


@pytest.fixture
def thin(never_small: None, small: Path, tmp_path: Path, sweep: Callable) -> Path:
    """Results of which the first run alone is whole."""
    out = tmp_path / "thin"
    result = sweep(small, out)
    assert result.exit_code == 0, result.stderr
    return out


def tables(out: Path) -> bytes:
    return (out / "small" / "tables.csv").read_bytes()


def reasons(small: Path, out: Path, *settings: str) -> dict[str, str]:
    steps = plan(load_scenario(small, settings), out, Selection())
    return {step.name: step.reason for step in steps if step.reason}


def test_tables_are_the_same_and_files_smaller(thin: Path, reference: Path) -> None:
    assert tables(thin) == tables(reference)
    name = "small/slow/filter-triad.000000.h5"
    whole, kept = store.read(reference / name), store.read(thin / name)
    for dataset, values in whole.items():
        if is_trajectory(dataset, "filter", values.ndim):
            assert np.array_equal(values[0], kept[dataset][0], equal_nan=True)
            assert np.array_equal(values[:, -1], kept[dataset][:, -1], equal_nan=True)
            assert np.isnan(kept[dataset][1:, :-1]).all()
        else:
            assert np.array_equal(values, kept[dataset])


def test_errors_over_time_are_of_all_runs(thin: Path, reference: Path) -> None:
    name = "small/slow/assess-triad.000000.h5"
    whole, kept = store.read(reference / name), store.read(thin / name)
    for dataset in ("rate", "pitch", "nis"):
        assert np.array_equal(whole[dataset], kept[dataset], equal_nan=True)


def test_more_is_kept_where_it_is_asked_for(thin: Path, small: Path, sweep: Callable) -> None:
    assert reasons(small, thin) == {}
    found = reasons(small, thin, "keep=2")
    assert all("filter" in name or "assess" in name for name in found)
    assert any("keeps the trajectories of 1 runs, those of 2" in why for why in found.values())
    sweep(small, thin, "--keep", "all")
    assert reasons(small, thin, "keep=all") == {}
    assert reasons(small, thin) == {}, "a file that keeps more serves"
    data = store.read(thin / "small/slow/filter-triad.000000.h5")
    assert np.isfinite(data["rate_b"]).all()


def test_a_filter_without_trajectories_runs_again_before_it_is_assessed(
    thin: Path, reference: Path, small: Path, sweep: Callable
) -> None:
    (thin / "small/slow/assess-triad.000000.h5").unlink()
    assert reasons(small, thin) == {
        "small slow: filter triad, runs 0-2": "assess needs its trajectories",
        "small slow: assess triad, runs 0-2": "not there yet",
    }
    assert sweep(small, thin).exit_code == 0
    assert tables(thin) == tables(reference)


def test_what_is_not_kept_is_said(thin: Path, small: Path, cli: Callable) -> None:
    result = cli("plot", small, "--out", thin, "--run", 2, "--figure", "rates")
    assert result.exit_code == 2
    assert "run 2 are not kept; sweep with --keep all or --keep 3" in result.stderr
    result = cli("plot", small, "--out", thin, "--run", 2, "--figure", "raw_quaternion")
    assert result.exit_code == 0, result.stderr
    result = cli("estimates", small, "--out", thin, "--run", 1, "--at", 30)
    assert result.exit_code == 2
    assert "--at 30" in result.stderr and "--keep 2" in result.stderr
    for asked in (["--run", 1], ["--run", 0, "--at", 30]):
        assert cli("estimates", small, "--out", thin, *asked).exit_code == 0


def test_exported_rows_are_those_that_are_kept(thin: Path, small: Path, cli: Callable) -> None:
    import pandas as pd

    cli("estimates", small, "--out", thin)
    rows = pd.read_csv(thin / "small" / "estimates.csv")
    epochs = rows[rows["quantity"] == "rate_b"].groupby("run")["time_s"].nunique()
    assert epochs[0] > 10
    assert (epochs[1:] == 1).all()


def test_rerun_gives_the_same_bytes(thin: Path, cli: Callable) -> None:
    for stage in ("filter", "assess"):
        result = cli("rerun", thin / f"small/slow/{stage}-triad.000000.h5")
        assert result.exit_code == 0 and "same bytes" in result.stdout, result.output


def test_a_run_without_trajectories_is_one_run_without_them(thin: Path) -> None:
    results = open_results(thin / "small")
    assert results.is_whole("slow", "triad", 0) and not results.is_whole("slow", "triad", 1)
    whole, thinned = (results.one_run("slow", "triad", run) for run in (0, 1))
    assert {"rate_b", "rate"} <= whole.keys()
    assert "rate_b" not in thinned and "rate" in thinned


@pytest.mark.parametrize("runs", [1, 7, 20])
def test_what_is_compressed_comes_back(runs: int) -> None:
    rng = np.random.default_rng(5)
    rate = rng.standard_normal((runs, 1499, 3))
    same = np.tile(rng.standard_normal((1, 1499, 4)), (runs, 1, 1))
    seen = np.where(rng.random((runs, 1499, 1, 30, 1)) < 0.01, rng.random((2,)), np.nan)
    ends = np.where((np.abs(np.arange(1499) - 700) < 600)[:, None], np.nan, rate)
    data = as_stored(
        {
            "run": np.arange(runs),
            "time_s": np.arange(1499),
            "rate_b": rate,
            "true_q_ib": same,
            "measured_pixel": seen,
            "q_ib": np.full((runs, 1499, 4), np.nan),
            "true_position": ends,
        }
    )
    image = image_of(data, {"datasets": "{}"}, {})
    with opened(image) as file:
        plain, packed = file["rate_b"], file["measured_pixel"]
        assert plain.compression is None and packed.compression == "gzip"
        assert file["q_ib"].id.get_storage_size() == 0
        assert file["true_position"].id.get_storage_size() < 0.3 * rate.nbytes
        assert data.keys() <= file.keys()
        for name, values in data.items():
            assert file[name][()].tobytes() == values.tobytes(), name
        assert np.array_equal(file["true_q_ib"][runs - 1 : runs], same[-1:])
    assert runs == 1 or len(image) < 1.15 * rate.nbytes + 0.2 * seen.nbytes + same.nbytes / runs * 2


def test_no_trajectory_is_in_a_simulation() -> None:
    for name, quantity in VOCABULARY.items():
        assert not is_trajectory(name, "simulate", len(quantity.axes))
        assert not is_trajectory(name, "recover", len(quantity.axes))
