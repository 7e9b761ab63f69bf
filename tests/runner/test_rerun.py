"""What a file of results stores can be run again, and gives the same bytes."""

from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from debrisest.results import store
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.scenario.case import Case
from debrisest.scenario.load import load_scenario
from debrisest.scenario.resolved import resolved

SHIPPED = sorted(path.stem for path in (Path(__file__).parents[2] / "configs").glob("*.yaml"))


def read_again(case: Case, folder: Path) -> Case:
    """The only case of what is stored of a case."""
    path = folder / f"{case.scenario_name}.yaml"
    path.write_text(resolved(case), encoding="utf-8")
    (again,) = load_scenario(path).cases.values()
    return again


@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_stored_of_a_case_has_the_same_keys_of_all_stages(
    name: str, shipped: Path, tmp_path: Path
) -> None:
    scenario = load_scenario(shipped / f"{name}.yaml")
    for case in scenario.cases.values():
        alone = scenario._replace(cases={case.name: case})
        again = scenario._replace(cases={case.name: read_again(case, tmp_path)})
        of_each = [plan(one, tmp_path, Selection(runs=1)) for one in (alone, again)]
        assert [step.key for step in of_each[0]] == [step.key for step in of_each[1]]


@pytest.mark.parametrize("stage", ["simulate", "recover-wahba", "filter-wahba", "assess-wahba"])
def test_the_same_bytes(stage: str, swept: Path, cli: Callable) -> None:
    path = swept / "small" / "slow" / f"{stage}.000000.h5"
    told = cli("rerun", path)
    assert (told.exit_code, told.stderr) == (0, "")
    assert told.stdout.startswith(f"{path}: same bytes (small slow: {stage.replace('-', ' ')}")


@pytest.mark.parametrize("folder", ["small@twin", "=copied.", "con"])
def test_from_folders_whose_names_no_scenario_has(folder: str, swept: Path, cli: Callable) -> None:
    (swept / "small").rename(swept / folder)
    path = swept / folder / "slow" / "filter-triad.000000.h5"
    told = cli("rerun", path)
    assert (told.exit_code, told.stderr) == (0, "")
    assert told.stdout.startswith(f"{path}: same bytes ({folder} slow: filter triad, runs 0-2")


GRID = "grid: {sensors.points.noise_m: [0.01, 0.02], motion.rate_deg_s: [[1, 2, 3]]}\n"
CASE = "fast,noise_m=0.02,rate_deg_s=1,2,3"


def test_later_runs_of_a_grid_with_overrides(
    small: Path, tmp_path: Path, sweep: Callable, cli: Callable
) -> None:
    text = small.read_text().replace("  published: small.csv\n", "").replace("[slow, fast]", "[]")
    small.write_text(text + GRID)
    some = ("--estimator", "triad", "--runs", 22, "--set", "seed=12")
    assert sweep(small, tmp_path / "out", *some, "--case", CASE).exit_code == 0
    small.unlink()
    for stage in ("simulate", "assess-triad"):
        path = tmp_path / "out" / "small@seed=12" / CASE / f"{stage}.000020.h5"
        told = cli("rerun", path)
        assert told.exit_code == 0, told.output
        assert f"{path}: same bytes" in told.stdout
        assert "runs 20-21" in told.stdout


def test_measured_data_are_found_from_anywhere(
    shipped: Path, tmp_path: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tracks.csv").write_bytes((shipped / "examples" / "tracks.csv").read_bytes())
    assert cli("import", "tracks.csv").exit_code == 0
    (scenario,) = tmp_path.rglob("tracks.yaml")
    assert cli("sweep", scenario, "--jobs", 1, "--quiet").exit_code == 0
    monkeypatch.chdir("/")
    files = sorted((tmp_path / "results").rglob("*.h5"))
    told = cli("rerun", *files)
    assert told.exit_code == 0, told.output
    assert told.stdout.count("same bytes") == len(files) > 2


def test_what_is_exported_runs_as_it_stands(
    swept: Path, tmp_path: Path, sweep: Callable, cli: Callable, data_of: Callable,
    same_data: Callable,
) -> None:  # fmt: skip
    told = cli("rerun", swept / "small" / "fast" / "assess-triad.000000.h5", "--export")
    (tmp_path / "small.yaml").write_text(told.stdout)
    again = sweep(tmp_path / "small.yaml", tmp_path / "again")
    assert again.exit_code == 0, again.output
    before, now = data_of(swept / "small" / "fast"), data_of(tmp_path / "again/small/fast")
    assert before.keys() == now.keys()
    assert all(same_data(before[name], now[name]) for name in before)


def test_what_differs_is_told(swept: Path, cli: Callable) -> None:
    path = swept / "small" / "slow" / "filter-triad.000000.h5"
    data, attributes = store.read(path), store.inspect(path).attributes
    data["rate_b"][0, 3, 1] += 1e-6
    del data["nis"]
    store.write(path, data, attributes | {"stage_key": "0"})
    told = cli("rerun", path)
    assert told.exit_code == 1
    assert told.stdout.splitlines()[1:] == [
        "  since then: an earlier stage was computed anew",
        "  nis: only computed now",
        "  rate_b: 1 of 540 values differ, by 1e-06 at most",
    ]


@pytest.mark.parametrize("content", [b"", b"my own notes"])
def test_what_is_no_result_is_refused(content: bytes, tmp_path: Path, cli: Callable) -> None:
    path = tmp_path / "simulate.000000.h5"
    path.write_bytes(content)
    for options in ([], ["--export"]):
        told = cli("rerun", path, *options)
        assert told.exit_code == 2
        assert "give a file of results" in told.stderr
    assert cli("rerun", tmp_path / "none.h5").exit_code == 2


def test_a_scenario_that_is_valid_no_more_is_told_with_its_key(swept: Path, cli: Callable) -> None:
    path = swept / "small" / "slow" / "simulate.000000.h5"
    data, attributes = store.read(path), store.inspect(path).attributes
    old = yaml.safe_load(attributes["scenario"]) | {"colour": "red"}
    store.write(path, data, attributes | {"scenario": yaml.safe_dump(old)})
    told = cli("rerun", path)
    assert told.exit_code == 2
    assert f"{path}, scenario:3:1: colour: unknown key" in told.stderr
