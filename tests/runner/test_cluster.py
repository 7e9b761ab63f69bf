"""A cluster proves itself before it computes, and what it reports to be done is read back."""

import asyncio
import os
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest

from debrisest.errors import UserError
from debrisest.fingerprint import fingerprint
from debrisest.runner import cluster, read_back
from debrisest.runner.executors import InProcess
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.sweep import Machine, bring_up_to_date
from debrisest.scenario.load import load_scenario


class Client:
    """What is used of dask's client, with workers that answer as they are told."""

    status = "running"

    def __init__(self, answers: dict[str, Any], computes: bool = True) -> None:
        self.answers, self.computes = answers, computes

    def wait_for_workers(self, _: int, timeout: float) -> None:
        if not self.answers:
            raise TimeoutError

    def run(self, fn: Callable, text: str, on_error: str) -> dict[str, Any]:
        return {name: a or fn(text) for name, a in self.answers.items()}

    def nthreads(self) -> dict[str, int]:
        return dict.fromkeys(self.answers, 1)

    def get_executor(self) -> Any:
        return InProcess() if self.computes else self

    def submit(self, *_: Any) -> Future[Any]:
        return Future()


def test_what_is_imported_counts_not_what_a_list_of_packages_says(tmp_path: Path) -> None:
    """A numpy of another version that PYTHONPATH puts before the installed one has no metadata."""
    (tmp_path / "numpy.py").write_text("__version__ = '1.0'\n")
    told = "import debrisest.fingerprint as f; f._BELOW = ('numpy',); print(f.fingerprint())"
    found = subprocess.run(
        [sys.executable, "-c", told],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path])},
        capture_output=True,
        text=True,
    )
    assert "'numpy': '1.0'" in found.stdout, found.stderr


OLD = fingerprint() | {"debrisest": "0" * 16}


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        ({}, ["no worker joined", "within 30 s", "dask worker tcp://x"]),
        ({"a": None, "b": OLD}, ["worker b: debrisest 0000", "expected", "install the same"]),
        ({"a": fingerprint() | {"numpy": "1.0"}}, ["worker a: numpy 1.0", "(expected", "same"]),
        ({"a": fingerprint() | {"python": "3.12.1"}, "b": None}, ["worker a: python 3.12.1"]),
        ({"a": ModuleNotFoundError("No module")}, ["worker a", "no debrisest like this one"]),
    ],
)
def test_workers_prove_themselves(answers: dict[str, Any], words: list[str]) -> None:
    with pytest.raises(UserError) as told:
        cluster._prove_workers(Client(answers), "dask:tcp://x")
    assert all(word in str(told.value) for word in words), told.value


def test_equal_workers_are_taken() -> None:
    cluster._prove_workers(Client({"a": None, "b": None}), "dask:tcp://x")


def test_a_worker_that_joins_later_is_asked_with_every_step() -> None:
    assert cluster.run_proven(fingerprint(), max, 1, 2) == 2
    with pytest.raises(ValueError, match="other versions: debrisest"):
        cluster.run_proven(OLD, max, 1, 2)


@pytest.mark.parametrize(("lost", "words"), [("workers", "no worker"), ("status", "connection")])
def test_a_lost_cluster_ends_what_is_running(
    lost: str, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.05)
    monkeypatch.setattr(cluster, "_CHECKED_EVERY_S", 0.02)
    client = Client({"a": None}, computes=False)
    with cluster._Cluster(client) as pool:
        running = pool.submit(max, 1, 2)
        time.sleep(0.1)
        assert not running.done()
        if lost == "workers":
            client.answers = {}
        else:
            client.status = "closed"
        with pytest.raises(cluster.ClusterLost, match=words):
            running.result(timeout=20)


@pytest.mark.parametrize("how", ["cancel", "exception"])
def test_what_a_client_without_its_scheduler_cancels_is_lost(how: str) -> None:
    """It may cancel before anyone sees that the connection is gone: nothing waits for ever."""
    theirs: Future[Any] = Future()
    client = Client({"a": None}, computes=False)
    client.submit = lambda *_: theirs  # type: ignore[method-assign]
    with cluster._Cluster(client) as pool:
        running = pool.submit(max, 1, 2)
        theirs.cancel() if how == "cancel" else theirs.set_exception(asyncio.CancelledError())
        with pytest.raises(cluster.ClusterLost, match="connection"):
            running.result(timeout=20)


def test_files_in_another_folder_are_missed(
    small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from contextlib import contextmanager

    class Elsewhere(InProcess):
        """Says that it computed; its files went elsewhere."""

        def submit(self, *_: Any, **__: Any) -> Future[Any]:
            return super().submit(max, 1, 2)

    @contextmanager
    def executor(*_: Any) -> Any:
        yield Elsewhere(), 1

    monkeypatch.setattr(read_back, "PATIENCE_S", 0.0)
    monkeypatch.setattr("debrisest.runner.sweep.executor", executor)
    scenario = load_scenario(small)
    selection = Selection(cases=["slow"], estimators=["triad"])
    failed = bring_up_to_date([scenario], tmp_path, selection, Machine(1, "dask:tcp://x", True))
    (why,) = failed.values()
    assert "must be shared" in why
    assert all(step.reason for step in plan(scenario, tmp_path, selection))
