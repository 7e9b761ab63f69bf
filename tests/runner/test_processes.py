"""Signals end a command with a sentence, and no worker outlives the process that started it."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from debrisest import interrupts


def wait_until(done: Callable[[], bool], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end
        time.sleep(0.01)


def alive(group: int) -> list[str]:
    """The processes of a group that are no zombies."""
    command = ["pgrep", "-g", str(group), "-r", "R,S,D,T"]
    return subprocess.run(command, capture_output=True, text=True).stdout.split()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL, signal.SIGINT, signal.SIGHUP])
@pytest.mark.parametrize("jobs", [1, 2])
def test_no_worker_is_left(
    number: signal.Signals, jobs: int, small: Path, tmp_path: Path, process: Callable
) -> None:
    running = process("sweep", small, "--out", tmp_path, "--jobs", jobs, "--runs", 60)
    wait_until(lambda: len(list(tmp_path.rglob("*.h5"))) > 0)
    os.kill(running.pid, number)
    _, told = running.communicate(timeout=60)
    assert running.returncode == (-9 if number == signal.SIGKILL else 128 + number), told
    assert (interrupts.SENTENCE in told) == (number != signal.SIGKILL)
    assert "Traceback" not in told
    wait_until(lambda: not alive(running.pid))


def test_a_signal_during_imports_ends_at_once_with_a_sentence() -> None:
    code = (
        "import os, signal, sys; from debrisest import interrupts; interrupts.listen()\n"
        "try: os.kill(os.getpid(), signal.SIGTERM)\n"
        "except BaseException: sys.exit('it was raised')"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (143, interrupts.SENTENCE + "\n")


def test_a_signal_during_the_writing_of_a_file_leaves_no_temporary_one(tmp_path: Path) -> None:
    code = (
        "import os, signal, sys; from pathlib import Path\n"
        "from debrisest import files, interrupts\n"
        "interrupts.before_end(files.remove_own); interrupts.listen()\n"
        "with files.replacing(Path(sys.argv[1])): os.kill(os.getpid(), signal.SIGTERM)"
    )
    ended = subprocess.run([sys.executable, "-c", code, tmp_path / "file"])
    assert (ended.returncode, list(tmp_path.iterdir())) == (143, [])


def test_who_asked_for_it_goes_on_when_the_terminal_closes() -> None:
    code = (
        "import os, signal; signal.signal(signal.SIGHUP, signal.SIG_IGN)\n"
        "from debrisest import interrupts; interrupts.listen()\n"
        "os.kill(os.getpid(), signal.SIGHUP); print('on')"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "on\n", "")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_an_exception_that_is_swallowed_is_raised_at_the_next_step(number: signal.Signals) -> None:
    before = [signal.getsignal(one) for one in interrupts.SIGNALS]
    try:
        interrupts.listen()
        with pytest.raises(interrupts.Interrupted) as raised, interrupts.raised() as check:
            check()
            with suppress(KeyboardInterrupt):
                os.kill(os.getpid(), number)
            check()
    finally:
        for one, handler in zip(interrupts.SIGNALS, before):
            signal.signal(one, handler)
    assert raised.value.exit_code == 128 + number


def test_a_notebook_keeps_its_own_handlers() -> None:
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    with interrupts.raised():
        assert (signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)) == before


def test_a_script_without_a_main_guard_is_told_so(small: Path, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(f"import debrisest\ndebrisest.run({str(small)!r}, 'out', jobs=2)\n")
    ended = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, cwd=tmp_path, timeout=120
    )
    assert ended.returncode == 1
    assert '__name__ == "__main__"' in ended.stderr
    assert "multiprocessing" not in ended.stderr


@pytest.mark.parametrize("started", [0, 1, 2])
def test_where_no_more_threads_are_started_a_sentence_ends_the_command(
    started: int, small: Path, tmp_path: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The pool has three: one hears its workers, one hands out work, one sends it."""
    original, before = threading.Thread.start, threading.excepthook
    seen: list[threading.Thread] = []

    def start(thread: threading.Thread) -> None:
        if len(seen) == started:
            raise RuntimeError("can't start new thread")
        seen.append(thread)
        original(thread)

    one = (small, "--out", tmp_path / "out", "--case", "slow", "--estimator", "triad", "--quiet")
    with monkeypatch.context() as patch:
        patch.setattr(threading.Thread, "start", start)
        done = cli("sweep", *one, "--jobs", 2)
    assert done.exit_code in (1, 2)
    assert "no more processes or threads are started" in done.stderr
    assert "Traceback" not in done.stderr
    wait_until(lambda: not multiprocessing.active_children())
    assert threading.excepthook == before
    assert cli("sweep", *one, "--jobs", 1).exit_code == 0


def test_a_worker_that_cannot_watch_its_parent_ends_without_a_trace() -> None:
    code = (
        "import multiprocessing, threading\n"
        "from debrisest.runner import executors\n"
        "def none(self): raise RuntimeError('can\\'t start new thread')\n"
        "threading.Thread.start = none\n"
        "multiprocessing.parent_process = lambda: 1\n"
        "executors._follow_parent(None, None)"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (1, "")
