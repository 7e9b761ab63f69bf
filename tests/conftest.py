"""A small scenario, its results, and the command line in this process and in others."""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from debrisest.catalog import CATALOG
from debrisest.cli import app
from debrisest.plugins import load
from debrisest.results import store
from debrisest.scenario.document import Place, merge, nested, text_of
from debrisest.scenario.document import parse as document_of
from debrisest.vocabulary import VOCABULARY

SCENARIOS = Path(__file__).parent / "scenarios"


@pytest.fixture(scope="session")
def shipped() -> Path:
    """The folder of the scenarios that come with the package."""
    return Path(__file__).parent.parent / "configs"


@pytest.fixture(scope="session")
def small_text() -> str:
    return (SCENARIOS / "small.yaml").read_text()


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """The small scenario in a folder of its own."""
    for name in ("small.yaml", "small.csv"):
        shutil.copy(SCENARIOS / name, tmp_path)
    return tmp_path / "small.yaml"


@pytest.fixture(scope="session")
def cli() -> Callable:
    """Run a command in this process; anything but a regular exit is raised."""

    def run(*arguments: object):
        result = CliRunner().invoke(app, [str(argument) for argument in arguments])
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return run


@pytest.fixture(scope="session")
def sweep(cli: Callable) -> Callable:
    """Sweep a scenario in this process."""

    def run(config: Path, out: Path, *options: object):
        return cli("sweep", config, "--out", out, "--jobs", 1, *options)

    return run


@pytest.fixture(scope="session")
def rewrite() -> Callable:
    """Write settings into a scenario's file, in place, as ``--set`` would lay them on it."""

    def write(config: Path, *settings: str) -> Path:
        document, _ = document_of(config.read_text(), str(config))
        for setting in settings:
            key, _, value = setting.partition("=")
            given = document_of(f"value: {value}", "")[0].value["value"]
            laid = nested(tuple(key.split(".")), given, Place(""))
            document = merge(document, laid)
        config.write_text(text_of(document.value))
        return config

    return write


@pytest.fixture(scope="session")
def reference(tmp_path_factory: pytest.TempPathFactory, sweep: Callable) -> Path:
    """The folder of results of the small scenario, made once; copy it before changing it."""
    out = tmp_path_factory.mktemp("reference")
    result = sweep(SCENARIOS / "small.yaml", out)
    assert result.exit_code == 0, result.output
    return out


@pytest.fixture
def swept(reference: Path, tmp_path: Path) -> Path:
    """A copy of the results of the small scenario."""
    return Path(shutil.copytree(reference, tmp_path / "swept"))


@pytest.fixture(scope="session")
def data_of() -> Callable:
    """Return the datasets of every file of a folder of results, by relative path."""

    def read(out: Path, pattern: str = "*.h5") -> dict[str, dict[str, np.ndarray]]:
        return {str(p.relative_to(out)): store.read(p) for p in sorted(out.rglob(pattern))}

    return read


@pytest.fixture(scope="session")
def same_data() -> Callable:
    """Whether two sets of datasets agree in every bit."""

    def same(first: dict[str, np.ndarray], second: dict[str, np.ndarray]) -> bool:
        return first.keys() == second.keys() and all(
            first[name].dtype.kind == second[name].dtype.kind
            and np.array_equal(first[name], second[name], equal_nan=first[name].dtype.kind == "f")
            for name in first
        )

    return same


@pytest.fixture
def untouched_catalog(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Nothing that a test loads is there for the next one."""
    for role, parts in CATALOG.items():
        monkeypatch.setitem(CATALOG, role, parts)
    monkeypatch.setattr(load, "_loaded", {})
    load._load_installed.cache_clear()
    known = dict(VOCABULARY)
    yield
    load._load_installed.cache_clear()
    VOCABULARY.clear()
    VOCABULARY.update(known)


@pytest.fixture(scope="session")
def process() -> Callable:
    """Start the command line as a process of its own, leader of its process group.

    It hears what a shell or nohup above the tests ignores.
    """

    def heard() -> None:
        for number in (signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)

    def start(*arguments: object) -> subprocess.Popen:
        environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        return subprocess.Popen(
            [sys.executable, "-m", "debrisest", *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=environment,
            start_new_session=True,
            preexec_fn=heard,
        )

    return start
