"""Files that take the place of others in one step, what killed writers leave, and locks."""

import errno
import os
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from debrisest import files
from debrisest.errors import UserError
from debrisest.files import remove_leftovers, replacing
from debrisest.locked import locked

WRITES = """
import sys
from pathlib import Path
from debrisest.files import replacing
with replacing(Path(sys.argv[1])) as temporary:
    temporary.write_text("half")
    print(temporary, flush=True)
    sys.stdin.read()
"""
HOLDS = """
import sys
from pathlib import Path
from debrisest.locked import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def start() -> Iterator[Callable]:
    """Start a script that says something and waits; return the process and what it said."""
    running: list[subprocess.Popen] = []

    def run(script: str, path: Path) -> tuple[subprocess.Popen, str]:
        command = [sys.executable, "-c", script, str(path)]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        running.append(subprocess.Popen(command, **pipes))
        return running[-1], running[-1].stdout.readline().strip()

    yield run
    for process in running:
        process.kill()
        process.communicate()


def test_a_leftover_is_removed_once_its_writer_is_dead(tmp_path: Path, start: Callable) -> None:
    """A killed writer that nobody has waited for, a zombie, is dead too."""
    writer, temporary = start(WRITES, tmp_path / "case" / "file")
    remove_leftovers(tmp_path)
    assert Path(temporary).exists()
    writer.kill()
    writer.stdout.read()
    os.waitid(os.P_PID, writer.pid, os.WEXITED | os.WNOWAIT)
    remove_leftovers(tmp_path)
    assert list((tmp_path / "case").iterdir()) == []


def test_files_of_other_machines_and_of_users_stay(tmp_path: Path) -> None:
    here = socket.gethostname()
    names = [
        ".0123.big" + here + ".tmp",
        f".0123.{here}.org.tmp",
        ".notes.tmp",
        f"a.0123.{here}.tmp",
    ]
    for name in names:
        (tmp_path / name).write_text("mine")
    remove_leftovers(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)


def test_a_writer_whose_file_was_taken_for_a_leftover_makes_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fcntl

    original, removed = fcntl.flock, []

    def slow(descriptor: int, how: int) -> None:
        if not removed:
            (path,) = tmp_path.iterdir()
            path.unlink()
            removed.append(path)
        original(descriptor, how)

    monkeypatch.setattr(fcntl, "flock", slow)
    with replacing(tmp_path / "file") as temporary:
        temporary.write_text("whole")
    assert removed
    assert (tmp_path / "file").read_text() == "whole"


def test_files_are_as_readable_as_others(tmp_path: Path) -> None:
    with replacing(tmp_path / "file") as temporary:
        temporary.write_text("whole")
    (tmp_path / "other").write_text("whole")
    assert (tmp_path / "file").stat().st_mode == (tmp_path / "other").stat().st_mode


@pytest.mark.parametrize("name", ["file", "f" * 255])
def test_no_room_is_told_with_the_path(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_text("before")
    with pytest.raises(OSError) as caught, replacing(path) as temporary:
        temporary.write_text("half")
        raise OSError(errno.ENOSPC, "No space left on device")
    assert str(caught.value) == f"[Errno 28] No space left on device: '{path}'"
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]


def test_an_error_about_another_file_keeps_its_name(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError) as caught, replacing(tmp_path / "file"):
        (tmp_path / "source").read_text()
    assert caught.value.filename == str(tmp_path / "source")


def test_a_lock_says_who_holds_it(tmp_path: Path, start: Callable) -> None:
    holder, _ = start(HOLDS, tmp_path / "folder")
    with pytest.raises(UserError) as caught, locked(tmp_path / "folder"):
        pass
    assert f"process {holder.pid} on {socket.gethostname()} writes there now" in str(caught.value)
    assert "--out" in str(caught.value)
    with locked(tmp_path / "another"):
        pass


def test_a_lock_ends_with_its_process(tmp_path: Path, start: Callable) -> None:
    holder, _ = start(HOLDS, tmp_path)
    holder.kill()
    holder.communicate()
    with locked(tmp_path):
        assert str(os.getpid()) in (tmp_path / ".lock").read_text()
        with pytest.raises(UserError), locked(tmp_path):
            pass
    assert list(tmp_path.iterdir()) == []


def test_a_lock_that_has_no_room_for_a_name_holds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.write", full)
    held = pytest.raises(UserError, match="another command writes there")
    with locked(tmp_path), held, locked(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_pipe_that_is_named_like_a_leftover_is_not_waited_for(tmp_path: Path) -> None:
    pipe = tmp_path / f".0123456789ab.{socket.gethostname()}.tmp"
    os.mkfifo(pipe)
    files.remove_leftovers(tmp_path)
    assert pipe.exists()


@pytest.mark.parametrize("kind", ["folder", "pipe", "loop", "link to a folder"])
def test_what_is_no_file_is_no_lock(kind: str, small: Path, swept: Path, sweep: Callable) -> None:
    lock = swept / "small" / ".lock"
    make: dict[str, Callable] = {
        "folder": lock.mkdir,
        "pipe": lambda: os.mkfifo(lock),
        "loop": lambda: lock.symlink_to(lock),
        "link to a folder": lambda: lock.symlink_to(swept),
    }
    make[kind]()
    done = sweep(small, swept)
    assert (done.exit_code, done.stdout) == (2, "")
    told = f"{lock}: this is no file, so that it cannot be a lock; move it away\n"
    assert done.stderr == told
    assert os.path.lexists(lock)


def test_two_sweeps_in_one_folder(
    small: Path, swept: Path, sweep: Callable, start: Callable
) -> None:
    holder, _ = start(HOLDS, swept / "small")
    done = sweep(small, swept, "--force")
    assert (done.exit_code, done.stdout) == (2, "")
    (told,) = done.stderr.splitlines()
    assert f"{swept / 'small'}: process {holder.pid}" in told
    holder.communicate("")
    assert sweep(small, swept).exit_code == 0


def test_a_sweep_removes_leftovers(swept: Path, small: Path, sweep: Callable) -> None:
    left = swept / "small" / "slow" / f".0123.{socket.gethostname()}.tmp"
    left.write_bytes(b"half")
    assert sweep(small, swept).exit_code == 0
    assert not left.exists()


def test_without_locks_files_are_whole_and_none_is_taken_for_a_leftover(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on Windows."""
    monkeypatch.setattr(files, "fcntl", None)
    with locked(tmp_path), files.replacing(tmp_path / "a") as temporary:
        temporary.write_text("whole")
        files.remove_leftovers(tmp_path)
        assert temporary.exists()
    assert {path.name for path in tmp_path.iterdir()} - {".lock"} == {"a"}
