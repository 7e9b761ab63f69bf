"""Results from their folder alone: no scenario file, no plan, whatever else lies there."""

import re
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import yaml

from debrisest.errors import UserError
from debrisest.parts.recoveries.basis_pursuit import BasisPursuit
from debrisest.parts.sensors.feature_points import FeaturePoints
from debrisest.results import store
from debrisest.results.open import open_results
from debrisest.results.results import Results
from debrisest.results.sealed import sealed
from debrisest.vocabulary import VOCABULARY

SOME = ("--case", "slow", "--estimator", "triad")


@pytest.fixture
def alone(swept: Path, small: Path) -> Path:
    """The folder of one scenario, somewhere else, with nothing beside it."""
    small.unlink()
    return Path(shutil.move(swept / "small", swept / "moved"))


def test_what_is_there(alone: Path) -> None:
    results = open_results(str(alone))
    assert results.cases == ["fast", "slow"]
    assert results.estimators("slow") == ["triad", "wahba"]
    assert results.stages("slow") == ["simulate"]
    assert results.stages("slow", "wahba") == ["recover", "filter", "assess"]
    assert results.runs("slow", "wahba", "filter") == 3
    assert results.left_out == []
    assert results.failures() == []
    assert "2 cases, 14 files" in repr(results)


@pytest.mark.parametrize("stage", ["recover", "filter", "assess"])
def test_data_are_those_of_the_files(
    stage: str, alone: Path, data_of: Callable, same_data: Callable
) -> None:
    (expected,) = data_of(alone / "fast", f"{stage}-triad.*").values()
    assert same_data(open_results(alone).load("fast", "triad", stage), expected)


def test_a_stage_need_not_be_named(alone: Path, same_data: Callable) -> None:
    results = open_results(alone)
    for estimator, stage in (("", "simulate"), ("triad", "assess")):
        named = results.load("slow", estimator, stage)
        assert same_data(results.load("slow", estimator), named)


def test_some_datasets_of_some_runs(alone: Path) -> None:
    data = open_results(alone).load("slow", "triad", "assess", names=("run", "rate"), runs=2)
    assert data.keys() == {"run", "rate"}
    assert data["rate"].shape == (2, 60)


def test_the_scenario_is_told_by_the_files(alone: Path) -> None:
    scenario = open_results(alone).scenario("slow")
    assert (scenario["seed"], scenario["runs"]) == (7, 3)
    assert scenario["sensors"]["points"]["noise_m"] == 0.01
    assert list(scenario["estimators"]) == ["triad", "wahba"]
    assert yaml.safe_dump(scenario)


@pytest.fixture
def long(small: Path, tmp_path: Path, sweep: Callable) -> Path:
    """The results of 22 runs, in two files for each stage."""
    assert sweep(small, tmp_path / "long", *SOME, "--runs", 22).exit_code == 0
    return tmp_path / "long" / "small"


def test_chunks_are_joined(long: Path, data_of: Callable) -> None:
    results = open_results(long)
    for stage in ("recover", "filter", "assess"):
        data = results.load("slow", "triad", stage)
        assert data["run"].tolist() == list(range(22))
        parts = data_of(long, f"{stage}*").values()
        for name, values in data.items():
            if VOCABULARY[name].axes[0] == "run":
                assert len(values) == 22
                for part, first in zip(parts, (0, 20)):
                    whole = tuple(map(slice, part[name].shape[1:]))
                    mine = values[first : first + 20][(slice(None), *whole)]
                    kind = part[name].dtype.kind
                    assert np.array_equal(mine, part[name], equal_nan=kind == "f"), name
    assert results.load("slow", "triad", "filter", runs=21)["run"].tolist() == list(range(21))
    assert results.load("slow", "triad", "filter", runs=3)["run"].tolist() == [0, 1, 2]


def test_one_run_of_a_later_file(long: Path) -> None:
    results = open_results(long)
    run = results.one_run("slow", "triad", 21)
    assert run["run"] == 21
    for stage, name in (("", "measured_point"), ("filter", "rate_b"), ("assess", "rate")):
        data = results.load("slow", "triad" * bool(stage), stage, names=("run", name))
        np.testing.assert_array_equal(run[name], data[name][21])


# what is damaged, foreign or not there


def test_damaged_and_foreign_files_are_named_and_left_out(
    alone: Path, reference: Path, same_data: Callable
) -> None:
    case = alone / "slow"
    truncated = case / "filter-triad.000000.h5"
    truncated.write_bytes(truncated.read_bytes()[:5000])
    (case / "notes.h5").write_text("my notes")
    (case / "folder.h5").mkdir()
    (case / "notes.txt").write_text("no file of results by its name")
    shutil.copy(case / "simulate.000000.h5", case / "copy.h5")
    other = case / "recover-wahba.000000.h5"
    attributes = store.inspect(other).attributes | {"schema_version": store.SCHEMA_VERSION - 1}
    other.write_bytes(sealed(other.read_bytes(), attributes))
    results = open_results(alone)
    assert set(results.left_out) == {
        f"{truncated} is truncated or damaged",
        f"{case / 'notes.h5'} is not a checkpoint of debrisest",
        f"{case / 'folder.h5'} is not a checkpoint of debrisest",
        f"{case / 'copy.h5'} is not named like a file of results",
        f"{case / 'recover-wahba.000000.h5'} is of another version of debrisest",
    }
    assert results.stages("slow", "triad") == ["recover", "assess"]
    assert results.stages("slow", "wahba") == ["filter", "assess"]
    whole = open_results(reference / "small").load("slow", "triad")
    assert same_data(results.load("slow", "triad"), whole)


def test_damaged_numbers_are_never_handed_over(alone: Path) -> None:
    """They are found when they are read, since opening reads no numbers."""
    path = alone / "slow" / "assess-triad.000000.h5"
    content = bytearray(path.read_bytes())
    content[9000] ^= 1
    path.write_bytes(content)
    results = open_results(alone)
    assert results.runs("slow", "triad", "assess") == 3
    with pytest.raises(UserError, match=f"{path} is truncated or damaged; a sweep"):
        results.load("slow", "triad")


def test_a_folder_without_results(tmp_path: Path, swept: Path) -> None:
    with pytest.raises(UserError, match="no results of a scenario there"):
        open_results(tmp_path / "none")
    with pytest.raises(UserError, match="open one of the folders in it: small"):
        open_results(swept)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        (("slwo",), "no case 'slwo'; there: fast, slow (did you mean slow?)"),
        (("slow", "triat"), "no estimator 'triat'; there: triad, wahba (did you mean triad?)"),
        (("slow", "triad", "fitler"), "no stage 'fitler'; there: recover, filter, assess"),
        (("slow", "", "assess"), "no stage 'assess'; there: simulate"),
    ],
)
def test_unknown_names_are_told(asked: tuple[str, ...], told: str, reference: Path) -> None:
    for method in (Results.load, Results.dataset):
        with pytest.raises(UserError) as caught:
            method(open_results(reference / "small"), *asked)
        assert told in str(caught.value)


def test_a_simulation_that_is_not_there(alone: Path) -> None:
    (alone / "slow" / "simulate.000000.h5").unlink()
    with pytest.raises(UserError, match="no stage 'simulate'"):
        open_results(alone).load("slow")


# failures


def test_failures_in_words(
    small: Path, tmp_path: Path, sweep: Callable, break_runs: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    with monkeypatch.context() as patch:
        break_runs(patch, FeaturePoints, "simulate", 2, {0})
        break_runs(patch, BasisPursuit, "recover", 0, {1})
        assert sweep(small, tmp_path / "out", "--case", "slow").exit_code == 1
    small.unlink()
    results = open_results(tmp_path / "out" / "small")
    failures = [(one.name, one.why.partition(":")[0]) for one in results.failures()]
    assert failures == [
        ("small slow: simulate, run 0", "sensors.points (feature_points)"),
        ("small slow: recover triad, run 1", "estimators.triad.recovery (basis_pursuit)"),
        ("small slow: recover wahba, run 1", "estimators.wahba.recovery (basis_pursuit)"),
    ]
    assert all("the tank is empty" in one.why for one in results.failures())
    assert [one.name for one in results.failures("slow", "wahba")] == [
        "small slow: simulate, run 0", "small slow: recover wahba, run 1",
    ]  # fmt: skip
    assert results.failures("fast") == []
    assert results.first_good_run("slow") == 1
    assert results.first_good_run("slow", "wahba") == 2


# xarray


def test_datasets_have_coordinates_units_and_names(alone: Path) -> None:
    results = open_results(alone)
    dataset, data = (
        results.dataset("slow", "triad", "filter"),
        results.load("slow", "triad", "filter"),
    )
    assert set(map(str, dataset.variables)) == set(data)
    assert {"run", "time_s", "covariance_time_s", "error_name"} <= set(dataset.coords)
    assert dataset["rate_b"].dims == ("run", "time_s", "axis")
    assert dataset["rate_b"].attrs["units"] == "rad/s"
    assert dataset["rate_b"].attrs["long_name"] == VOCABULARY["rate_b"].long_name
    np.testing.assert_array_equal(dataset["rate_b"].values, data["rate_b"])
    late = dataset["rate_b"].sel(time_s=slice(40, 60))
    np.testing.assert_array_equal(late, data["rate_b"][:, data["time_s"] >= 40])


def test_datasets_say_the_frames_that_files_say(alone: Path) -> None:
    dataset = open_results(alone).dataset("slow")
    with h5py.File(alone / "slow" / "simulate.000000.h5") as file:
        said = {name: one.attrs["frame"] for name, one in file.items() if "frame" in one.attrs}
    assert said
    assert said == {str(n): v.attrs["frame"] for n, v in dataset.items() if "frame" in v.attrs}


def test_without_xarray_there_is_a_sentence(
    reference: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(UserError, match="pip install xarray"):
        open_results(reference / "small").dataset("slow")


# the guide


def test_the_example_of_the_guide(shipped: Path, reference: Path) -> None:
    guide = (shipped.parent / "docs" / "files.md").read_text(encoding="utf-8")
    example = re.search(r"^```python\n(from debrisest.*?)^```", guide, re.M | re.S)[1]
    mine = example.replace("results/first_steps", str(reference / "small"))
    found: dict[str, Any] = {}
    exec(mine.replace("noise_m=0.01", "slow"), found)
    assert found["data"].keys() == {"rate_b"}
    assert found["errors"]["rate"].attrs["units"] == "rad/s"
