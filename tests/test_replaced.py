"""Files that were replaced by others are never taken for those that were meant."""

import pickle
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from debrisest.errors import UserError
from debrisest.results import store
from debrisest.results.open import find_results, open_results
from debrisest.results.status import up_to_date
from debrisest.runner.compute import compute
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.step import Step
from debrisest.scenario.load import load_scenario

ONE = ("--case", "slow", "--estimator", "triad")
NAMES = ["simulate", "recover-triad", "filter-triad", "assess-triad"]


@pytest.fixture(scope="module")
def other(tmp_path_factory: pytest.TempPathFactory, sweep: Callable, shipped: Path) -> Path:
    """The same scenario with another seed: the same names and sizes, other numbers."""
    out = tmp_path_factory.mktemp("other")
    config = shipped.parent / "tests" / "scenarios" / "small.yaml"
    assert sweep(config, out, "--set", "seed=8").exit_code == 0
    return out / "small@seed=8" / "slow"


@pytest.mark.parametrize("name", NAMES[:3])
def test_replaced_by_another_command_while_a_sweep_runs(
    name: str, small: Path, tmp_path: Path, other: Path, reference: Path, sweep: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    out, original = tmp_path / "out", store.write

    def write(path: Path, *rest: Any) -> None:
        original(path, *rest)
        if path.match(f"slow/{name}.000000.h5"):
            shutil.copy(other / path.name, path)

    with monkeypatch.context() as patch:
        patch.setattr(store, "write", write)
        done = sweep(small, out)
    assert done.exit_code == 1
    path = out / "small" / "slow" / f"{name}.000000.h5"
    told = f"failed: {path} is another one than was expected there; a sweep computes it again"
    assert any(line.endswith(told) for line in done.stderr.splitlines())
    assert sweep(small, out).exit_code == 0
    for file in ("tables.csv", "tables.md"):
        assert (out / "small" / file).read_bytes() == (reference / "small" / file).read_bytes()


@pytest.mark.parametrize("name", NAMES)
def test_replaced_while_it_is_read(name: str, small: Path, swept: Path, other: Path) -> None:
    path = swept / "small" / "slow" / f"{name}.000000.h5"
    steps = plan(load_scenario(small), swept, Selection(cases=["slow"]))
    opened = open_results(swept / "small")
    shutil.copy(other / path.name, path)
    estimator = name.partition("-")[2]
    with pytest.raises(UserError, match=f"{path} is another one than was expected"):
        opened.load("slow", estimator, name.partition("-")[0])
    with pytest.raises(UserError, match=f"{path} was replaced while it was to be read"):
        up_to_date(find_results(swept / "small"), steps)


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory, sweep: Callable, shipped: Path) -> Path:
    """22 runs in two files for each stage."""
    out = tmp_path_factory.mktemp("long")
    config = shipped.parent / "tests" / "scenarios" / "small.yaml"
    assert sweep(config, out, *ONE, "--runs", 22).exit_code == 0
    return out


@pytest.mark.parametrize("name", NAMES)
def test_a_file_of_other_runs_is_computed_again(
    name: str, long: Path, small: Path, tmp_path: Path, sweep: Callable
) -> None:
    out = Path(shutil.copytree(long, tmp_path / "out"))
    first, second = (out / "small" / "slow" / f"{name}.{run}.h5" for run in ("000000", "000020"))
    shutil.copy(first, second)
    done = sweep(small, out, *ONE, "--runs", 22)
    assert done.exit_code == 0
    told = f"{second} is another one than was expected there: it is computed again"
    assert told in done.stderr.splitlines()
    tables = [folder / "small" / "tables.csv" for folder in (out, long)]
    assert tables[0].read_bytes() == tables[1].read_bytes()


@pytest.mark.parametrize(
    ("source", "target"),
    [
        ("fast/assess-triad", "slow/assess-triad"),
        ("slow/assess-wahba", "slow/assess-triad"),
        ("slow/filter-triad", "slow/assess-triad"),
    ],
)
def test_a_file_of_another_case_estimator_or_stage(
    source: str, target: str, swept: Path, small: Path, reference: Path, sweep: Callable
) -> None:
    paths = [swept / "small" / f"{name}.000000.h5" for name in (source, target)]
    shutil.copy(*paths)
    assert open_results(swept / "small").left_out == [
        f"{paths[1]} is another one than was expected there"
    ]
    done = sweep(small, swept)
    assert done.exit_code == 0
    assert "[1/1] small slow: assess triad" in done.stderr
    tables = [folder / "small" / "tables.csv" for folder in (swept, reference)]
    assert tables[0].read_bytes() == tables[1].read_bytes()


@pytest.fixture
def measured(tmp_path: Path, shipped: Path, cli: Callable) -> Path:
    """A scenario of a file of poses, which lies beside it."""
    poses = Path(shutil.copy(shipped / "examples" / "poses.csv", tmp_path))
    assert cli("import", poses).exit_code == 0
    config, read = poses.with_suffix(".yaml"), "kind: datasets\n  file: poses.h5"
    text = config.read_text()
    assert read in text
    config.write_text(text.replace(read, "kind: poses\n  file: poses.csv"))
    return config


def other_poses(config: Path) -> None:
    path = config.with_suffix(".csv")
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:-1]))


def in_another_process(step: Step) -> Step:
    return pickle.loads(pickle.dumps(step))


@pytest.mark.parametrize("where", [lambda step: step, in_another_process])
def test_measurements_that_change_between_plan_and_step(
    where: Callable, measured: Path, tmp_path: Path
) -> None:
    """As they do on a worker that has another file by the same path."""
    step = plan(load_scenario(measured), tmp_path / "out", Selection())[0]
    other_poses(measured)
    with pytest.raises(UserError, match=r"changed (while it was read|since this was planned)"):
        compute([where(step)])
    assert not step.path.exists()
    (again, *_) = plan(load_scenario(measured), tmp_path / "out", Selection())
    compute([again])
    assert store.inspect(again.path).attributes["stage_key"] == again.key != step.key


def test_measurements_that_change_while_they_are_read(
    measured: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = next(iter(load_scenario(measured).cases.values())).simulation
    original = type(case.source).read

    def read(source: Any, folder: Path) -> Any:
        found = original(source, folder)
        other_poses(measured)
        return found

    monkeypatch.setattr(type(case.source), "read", read)
    with pytest.raises(UserError, match=r"poses\.csv: this changed while it was read; run again"):
        _ = case.measured


def test_a_worker_with_another_installed_plug_in(
    small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    step = plan(load_scenario(small), tmp_path / "out", Selection(cases=["slow"]))[0]
    part = type(step.case.scenario.sensors["points"])
    monkeypatch.setattr(part, "plugin", {"plug-in lidar": "0" * 16})
    with pytest.raises(UserError, match=r"points: plug-in lidar changed: .* or another plug-in"):
        compute([step])
    assert not step.path.exists()
