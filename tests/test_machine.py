"""Faults of the machine: no room, no right, no terminal. They are told, and nothing is lost."""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from debrisest.results import store

ONE = ("--case", "slow", "--estimator", "triad", "--jobs", "1")


@pytest.fixture
def shell(small: Path) -> Callable:
    """Run a line of the shell in which ``$debrisest`` is the command line, beside the scenario."""

    def run(line: str, **environment: str) -> subprocess.CompletedProcess[str]:
        own = {"debrisest": f"{sys.executable} -m debrisest", "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(
            ["sh", "-c", line],
            cwd=small.parent,
            env=os.environ | own | environment,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=300,
        )
        assert "Traceback" not in done.stderr, done.stderr
        assert "Exception ignored" not in done.stderr, done.stderr
        return done

    return run


def left(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob(".*")]


@pytest.mark.parametrize("jobs", [1, 2])
def test_files_that_become_too_large(
    jobs: int, small: Path, tmp_path: Path, reference: Path, shell: Callable, sweep: Callable
) -> None:
    """The limit lets one stage pass and not another, as a disk does that becomes full."""
    sizes = {path.name: path.stat().st_size for path in (reference / "small").rglob("slow/*.h5")}
    blocks = (min(sizes.values()) + max(sizes.values())) // 1024
    done = shell(f"ulimit -f {blocks}; $debrisest sweep small.yaml --jobs {jobs} --out out")
    assert done.returncode == 1
    told = [line for line in done.stderr.splitlines() if "File too large" in line]
    assert told
    for line in told:
        path = Path(re.search(r"failed: (out/.*\.h5): File too large; the same", line)[1])
        assert not (tmp_path / path).exists()
    assert left(tmp_path / "out") == []
    assert sweep(small, tmp_path / "out").exit_code == 0
    tables = [folder / "small" / "tables.csv" for folder in (tmp_path / "out", reference)]
    assert tables[0].read_bytes() == tables[1].read_bytes()


def test_a_full_disk_ends_with_one_sentence(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path, _: bytes) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    done = sweep(small, tmp_path / "out", "--quiet")
    assert done.exit_code == 1
    path = tmp_path / "out" / "small" / "slow" / "simulate.000000.h5"
    (told,) = (line for line in done.stderr.splitlines() if "No space" in line)
    assert told == (
        f"small slow: simulate, runs 0-2 failed: {path}: No space left on device; "
        "the same command goes on from here"
    )
    assert left(tmp_path / "out") == []


def test_results_that_cannot_be_written(
    small: Path, swept: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is up to date is printed; what would have to be written is told."""

    def read_only(path: object, *_: object, **__: object) -> int:
        raise OSError(30, "Read-only file system", str(path))

    printed = cli("table", small, "--out", swept, "--runs", 3).stdout
    fewer = cli("table", small, "--out", swept, "--runs", 2).stdout
    cli("table", small, "--out", swept)
    monkeypatch.setattr("os.open", read_only)
    for command in ("table", "sweep"):
        done = cli(command, small, "--out", swept)
        assert (done.exit_code, done.stdout, done.stderr) == (0, printed, "")
    done = cli("table", small, "--out", swept, "--runs", 2)
    table = swept / "small" / "tables.csv"
    assert (done.exit_code, done.stdout) == (2, fewer)
    assert done.stderr == f"{table}: Read-only file system\n"
    done = cli("plot", small, "--out", swept, "--case", "slow", "--estimator", "wahba")
    assert done.exit_code == 2
    assert done.stderr.endswith(": Read-only file system\n")
    assert len(done.stderr.splitlines()) == 1


def test_nowhere_to_print(small: Path, tmp_path: Path, reference: Path, shell: Callable) -> None:
    shutil.copytree(reference, tmp_path / "results")
    for path in (tmp_path / "results" / "small").glob("tables.*"):
        path.unlink()
    done = shell("$debrisest table small.yaml >/dev/full")
    assert done.returncode == 2
    assert done.stderr == "standard output: No space left on device\n"
    for path in (reference / "small").glob("tables.*"):
        assert (tmp_path / "results" / "small" / path.name).read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    "where", ["1>&-", "2>&-", "2>/dev/full", "1>&- 2>&-", "| true", "2>&1 | true"]
)
def test_streams_that_lead_nowhere_stop_no_sweep(
    where: str, tmp_path: Path, reference: Path, shell: Callable
) -> None:
    shell(f"$debrisest sweep small.yaml {' '.join(ONE)} {where}")
    assert (tmp_path / "results" / "small" / "tables.csv").exists()
    assert len(list((tmp_path / "results").rglob("*.h5"))) == 4


@pytest.mark.parametrize("asked", ["--help", "rerun --help", "--version"])
@pytest.mark.parametrize("where", [">/dev/full", "1>&-", ">/dev/full 2>&-"])
def test_help_that_nobody_hears_is_no_trace(asked: str, where: str, shell: Callable) -> None:
    done = shell(f"$debrisest {asked} {where}")
    assert done.returncode in (0, 2)
    assert done.stderr in ("", "standard output: No space left on device\n")


def test_plots_are_drawn_whoever_listens(tmp_path: Path, reference: Path, shell: Callable) -> None:
    shutil.copytree(reference, tmp_path / "results")
    shell("$debrisest plot small.yaml --case slow --estimator wahba | true")
    assert len(list((tmp_path / "results" / "small" / "plots").glob("*.png"))) > 3


def test_a_code_page_that_lacks_letters(small: Path, reference: Path, shell: Callable) -> None:
    shutil.copytree(reference, small.parent / "results")
    text = small.read_text()
    small.write_text(text.replace("title: Pitch error of", "title: δ of", 1), encoding="utf-8")
    done = shell("$debrisest table small.yaml", PYTHONIOENCODING="ascii")
    assert done.returncode == 0
    assert "\\u03b4 of the recovered attitude" in done.stdout


ODD_ENVIRONMENTS = {
    "numbers": {"COLUMNS": "\u00b2", "LINES": "\u0bf0", "SOURCE_DATE_EPOCH": "soon"},
    "long numbers": {"COLUMNS": "9" * 30, "LINES": "1", "SOURCE_DATE_EPOCH": "9" * 20},
    "terminal": {"COLUMNS": "0", "TERM": "\x1b[2J", "NO_COLOR": "1", "FORCE_COLOR": "1"},
    "python": {"PYTHONOPTIMIZE": "2", "PYTHONWARNINGS": "error", "PYTHONHASHSEED": "3"},
    "language": {"LC_ALL": "xx_YY", "LANG": "xx.UTF-99", "PYTHONUTF8": "0"},
    "folders": {"HOME": "/dev/null", "TMPDIR": "/nonexistent", "GIT_DIR": "/x"},
    "libraries": {"MPLBACKEND": "nosuch", "OMP_NUM_THREADS": "x", "HDF5_USE_FILE_LOCKING": "x"},
    "drivers": {"HDF5_DRIVER": "nosuch", "HDF5_VOL_CONNECTOR": "no such", "HDF5_PLUGIN_PATH": ":"},
}


@pytest.mark.parametrize("name", ODD_ENVIRONMENTS)
def test_odd_environments_change_no_result(
    name: str, tmp_path: Path, reference: Path, shell: Callable
) -> None:
    line = f"$debrisest sweep small.yaml {' '.join(ONE)}"
    done = shell(f"{line} && $debrisest table small.yaml", **ODD_ENVIRONMENTS[name])
    assert done.returncode == 0, done.stderr
    path = Path("small") / "slow" / "assess-triad.000000.h5"
    ours, whole = (store.read(out / path) for out in (tmp_path / "results", reference))
    assert all(ours[key].tobytes() == value.tobytes() for key, value in whole.items())


def test_a_folder_that_is_gone_is_named(small: Path, shell: Callable) -> None:
    done = shell(
        'mkdir gone; cd gone; rmdir "$PWD"; '
        f"$debrisest sweep {small} {' '.join(ONE[:4])} --jobs 2 --out {small.parent}/out"
    )
    assert done.returncode == 2
    assert done.stderr.startswith("the folder that this command was started in is gone; start")
    assert len(done.stderr.splitlines()) == 1


def test_where_processes_share_no_locks_one_job_is_named(
    small: Path, tmp_path: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(*_: object, **__: object) -> None:
        raise OSError(38, "Function not implemented")

    monkeypatch.setattr("multiprocessing.synchronize.SemLock.__init__", refused)
    done = cli("sweep", small, "--out", tmp_path / "out", "--jobs", 2)
    assert done.exit_code == 2
    assert done.stderr == (
        "several processes need semaphores (on Linux /dev/shm): Function not implemented; "
        "--jobs 1 needs none\n"
    )


@pytest.mark.parametrize("command", ["table", "sweep", "status", "plot"])
@pytest.mark.parametrize("out", ["x" * 300, "y/" * 3000, "small.yaml", "small.yaml/out"])
def test_folders_that_cannot_be(
    command: str, out: str, small: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(small.parent)
    done = cli(command, small, "--out", out, *ONE[:4])
    assert done.exit_code in (0, 2)
    assert all(len(line) < 8000 for line in done.stderr.splitlines())
    assert command != "sweep" or done.exit_code == 2


def test_a_file_where_plots_should_go(small: Path, swept: Path, cli: Callable) -> None:
    plots = swept / "small" / "plots"
    plots.write_text("mine")
    done = cli("plot", small, "--out", swept, "--case", "slow")
    assert done.exit_code == 2
    assert done.stderr == f"{plots}: File exists\n"
    assert plots.read_text() == "mine"


@pytest.mark.skipif(os.geteuid() != 0, reason="becomes another user, to have no rights")
@pytest.mark.parametrize("mode", [0o000, 0o444, 0o111])
@pytest.mark.parametrize("command", ["table", "status", "sweep", "plot"])
def test_a_folder_without_rights(
    command: str, mode: int, small: Path, reference: Path, cli: Callable
) -> None:
    with tempfile.TemporaryDirectory() as place:
        out = Path(shutil.copytree(reference, Path(place) / "out"))
        config = Path(shutil.copytree(small.parent, Path(place) / "in")) / "small.yaml"
        folder = out / "small" / "slow"
        folder.chmod(mode)
        for parent in (out, config.parent, out.parent):
            parent.chmod(0o755)
        cli(command, config, "--out", out, *ONE[:4])
        os.seteuid(65534)
        try:
            done = cli(command, config, "--out", out)
        finally:
            os.seteuid(0)
    assert done.exit_code == 2
    (told,) = done.stderr.splitlines()
    assert told.startswith(str(folder))
    assert told.endswith(": Permission denied")


@pytest.mark.parametrize(
    "given",
    [
        ("import", "PIPE"),
        ("estimate", "PIPE"),
        ("estimate", "tracks.csv", "--points", "PIPE"),
        ("estimate", "tracks.csv", "--attitude", "PIPE"),
        ("estimate", "tracks.csv", "--camera", "PIPE"),
        ("estimate", "poses.csv", "--image-times", "PIPE"),
        ("import", "tracks.csv", "--scenario", "PIPE"),
        ("validate", "small.yaml", "--plugin", "PIPE"),
        ("rerun", "PIPE"),
        ("track", "PIPE", "--rate-hz", "1"),
        ("reconstruct", "PIPE"),
        ("compare", "PIPE", "PIPE"),
    ],
    ids=" ".join,
)
def test_pipes_that_nobody_writes_to_are_waited_for_by_no_command(
    given: tuple[str, ...],
    small: Path,
    shipped: Path,
    cli: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(small.parent)
    os.mkfifo(small.parent / "pipe.csv")
    for name in ("tracks", "poses"):
        shutil.copy(shipped / "examples" / f"{name}.csv", small.parent)
    words = [word.replace("PIPE", "pipe.csv") for word in given]
    paths = [small.parent / word if "." in word else word for word in words]
    with ended_after(20):
        done = cli(*paths)
    assert done.exit_code == 2
    assert "pipe.csv" in done.stderr
    assert "Traceback" not in done.stderr


@contextmanager
def ended_after(seconds: int) -> Iterator[None]:
    """Raise TimeoutError within where something waits for longer."""

    def stop(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("error", [MemoryError, ImportError("x.so: failed to map segment")])
def test_too_little_memory_is_a_sentence(
    error: Exception, small: Path, swept: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("debrisest.results.store.read_image", full)
    done = cli("table", small, "--out", swept)
    assert (done.exit_code, "not enough memory" in done.stderr) == (2, True)


@pytest.mark.parametrize("command", ["estimate", "import"])
@pytest.mark.parametrize("name", ["t\udcff.csv", "f\udcfe/tracks.csv"], ids=["file", "folder"])
def test_paths_that_are_no_text_are_refused_where_results_would_name_them(
    name: str, command: str, shipped: Path, tmp_path: Path, cli: Callable
) -> None:
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    shutil.copy(shipped / "examples" / "tracks.csv", path)
    done = cli(command, path)
    assert (done.exit_code, "no text in UTF-8" in done.stderr) == (2, True)
    assert sorted(path.parent.rglob("*.*")) == [path]


def test_results_go_to_a_folder_that_is_no_text(small: Path, tmp_path: Path, sweep: Callable):
    assert sweep(small, tmp_path / "r\udcff", *ONE).exit_code == 0


@pytest.mark.parametrize("folder", ["results", "results/small", "results/small/slow"])
def test_a_folder_that_is_moved_away_while_a_sweep_runs(
    folder: str, small: Path, reference: Path, shell: Callable
) -> None:
    """The sweep ends with sentences, or makes the folder anew; nobody counts what is not there."""
    none = '[ -z "$(ls results/small/slow/filter* 2>/dev/null)" ]'
    seen = f"while kill -0 $! 2>/dev/null && {none}; do sleep .1; done"
    sweep = "$debrisest sweep small.yaml --jobs 1 --quiet"
    done = shell(f"{sweep} >first & {seen}; mv {folder} away; wait $!; echo $?; {sweep} >again")
    assert done.stdout.strip() in ("0", "1", "2"), done.stderr
    tables = [place / "small" / "tables.csv" for place in (small.parent / "results", reference)]
    assert tables[0].read_bytes() == tables[1].read_bytes()
