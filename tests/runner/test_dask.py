"""A dask cluster of a real scheduler and two workers on this machine."""

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

pytest.importorskip("distributed")

PATIENCE_S = 400.0
QUIET = ("--no-dashboard", "--host", "127.0.0.1")
MANY = ("--case", "slow", "--estimator", "triad", "--runs", "80")


def until(there: Callable[[], object]) -> None:
    end = time.monotonic() + PATIENCE_S
    while not there():
        assert time.monotonic() < end, "the cluster does not move on"
        time.sleep(0.05)


class Cluster:
    """A scheduler and its workers, as processes that can be killed."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.file = folder, folder / "scheduler.json"
        self.workers: list[subprocess.Popen] = []
        told = ("--port", "0", "--scheduler-file", str(self.file), *QUIET)
        self.scheduler = self._start("dask_scheduler", *told)
        until(lambda: self.file.exists() and self.file.read_text().rstrip().endswith("}"))
        address = json.loads(self.file.read_text())["address"]
        self.address, self.option = address, ("--executor", f"dask:{address}")

    def add_worker(self, package: Path | None = None) -> None:
        """Start a worker, by default with the package that is tested."""
        told = ("--no-nanny", "--nthreads", "1", "--local-directory", str(self.folder), *QUIET)
        self.workers.append(self._start("dask_worker", self.address, *told, package=package))

    def _start(self, name: str, *told: str, package: Path | None = None) -> subprocess.Popen:
        paths = [str(package or Path(__file__).parents[2]), os.environ.get("PYTHONPATH", "")]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths)}
        command = [sys.executable, "-m", f"distributed.cli.{name}", *told]
        silent = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.Popen(command, cwd=self.folder, env=environment, **silent)

    def end(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    folder = tmp_path / "cluster"
    folder.mkdir()
    started = Cluster(folder)
    try:
        yield started
    finally:
        started.end()


@contextmanager
def command(config: Path, out: Path, *arguments: str) -> Iterator[subprocess.Popen]:
    """A sweep in a process of its own, which is ended in any case."""
    told = ("sweep", str(config), "--out", str(out), "--quiet", *arguments)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen([sys.executable, "-m", "debrisest", *told], **pipes) as running:
        try:
            yield running
        finally:
            running.kill()


def end_of(running: subprocess.Popen) -> tuple[int, str]:
    """The exit code of a sweep and what it told."""
    told = running.communicate(timeout=PATIENCE_S)[1]
    return running.returncode, told


def recovered(out: Path) -> list[Path]:
    return list(out.glob("small/slow/recover-*.h5"))


def written(out: Path) -> dict[Path, int]:
    """When each file of results was written."""
    return {path: path.stat().st_mtime_ns for path in out.rglob("*.h5")}


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory, sweep: Callable) -> str:
    """What the tables of many runs are where all is computed in this process."""
    folder = tmp_path_factory.mktemp("local")
    for name in ("small.yaml", "small.csv"):
        shutil.copy(Path(__file__).parents[1] / "scenarios" / name, folder)
    sweep(folder / "small.yaml", folder / "out", *MANY)
    return (folder / "out" / "small" / "tables.csv").read_text()


def test_two_workers_give_the_same_bytes(
    cluster: Cluster, small: Path, tmp_path: Path, reference: Path, data_of: Callable
) -> None:
    cluster.add_worker()
    cluster.add_worker()
    with command(small, tmp_path / "out", *cluster.option) as running:
        assert end_of(running) == (0, "")
    table = Path("small", "tables.csv")
    assert (tmp_path / "out" / table).read_bytes() == (reference / table).read_bytes()
    there, expected = data_of(tmp_path / "out"), data_of(reference)
    assert there.keys() == expected.keys()
    for name, data in there.items():
        assert {k: v.tobytes() for k, v in data.items()} == {
            k: v.tobytes() for k, v in expected[name].items()
        }


def test_a_worker_that_is_killed_costs_its_chunk_only(
    cluster: Cluster, small: Path, tmp_path: Path, tables: str
) -> None:
    out = tmp_path / "out"
    cluster.add_worker()
    cluster.add_worker()
    with command(small, out, *MANY, *cluster.option) as running:
        until(lambda: recovered(out))
        before = written(out)
        cluster.workers[0].kill()
        assert running.poll() is None, "it was over before the worker was killed"
        code, told = end_of(running)
    assert code == 0 and "failed" not in told, told
    assert len(before.items() - written(out).items()) <= 1, "a file may be written but not told yet"
    assert (out / "small" / "tables.csv").read_text() == tables


def test_a_scheduler_that_is_lost_in_mid_run_is_told_and_the_rest_is_kept(
    cluster: Cluster, small: Path, tmp_path: Path, tables: str, sweep: Callable
) -> None:
    out = tmp_path / "out"
    cluster.add_worker()
    with command(small, out, *MANY, *cluster.option) as running:
        until(lambda: recovered(out))
        cluster.scheduler.kill()
        code, told = end_of(running)
    assert code == 1
    assert "the connection to the dask scheduler was lost; start it and run again" in told
    assert "ERROR" not in told and "Traceback" not in told, told
    before = written(out)
    assert sweep(small, out, *MANY).exit_code == 0
    assert written(out).items() >= before.items()
    assert (out / "small" / "tables.csv").read_text() == tables


def test_no_scheduler(small: Path, tmp_path: Path) -> None:
    address = "dask:tcp://127.0.0.1:9"
    with command(small, tmp_path, "--executor", address) as running:
        assert end_of(running) == (2, f"--executor {address}: no dask scheduler answers there\n")


def test_a_worker_of_another_version(cluster: Cluster, small: Path, tmp_path: Path) -> None:
    package = Path(__file__).parents[2] / "debrisest"
    other = tmp_path / "other"
    shutil.copytree(package, other / "debrisest", ignore=shutil.ignore_patterns("__pycache__"))
    with (other / "debrisest" / "clock.py").open("a") as file:
        file.write("# another version\n")
    cluster.add_worker(other)
    with command(small, tmp_path / "out", *cluster.option) as running:
        code, told = end_of(running)
    assert code == 2
    assert "worker tcp://127.0.0.1" in told and "install the same" in told
    assert not list((tmp_path / "out").rglob("*.h5"))


def test_a_worker_with_another_numpy_computes_nothing(
    cluster: Cluster, small: Path, tmp_path: Path
) -> None:
    other = tmp_path / "other"
    other.mkdir()
    (other / "sitecustomize.py").write_text("import numpy\nnumpy.__version__ = '1.99.0'\n")
    cluster.add_worker(package=other)
    with command(small, tmp_path / "out", *cluster.option) as running:
        code, told = end_of(running)
    assert (code, len(told.splitlines())) == (2, 1), told
    assert "numpy 1.99.0 (expected" in told
    assert not list((tmp_path / "out").rglob("*.h5"))
