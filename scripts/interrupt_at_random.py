"""End sweeps at random moments by SIGKILL, SIGTERM and SIGINT, and tell what is wrong afterwards.

    python scripts/interrupt_at_random.py [--kill 30] [--term 30] [--int 30] [--seed 1] [--dask]

Each sweep is ended once, with one job, with two, and with ``--dask`` on a cluster of its own (extra
dask), in turn, and then brought to its end: nothing may be left running, nobody may see a trace, no
temporary file may stay, and tables and data must be those of an undisturbed sweep, to the byte.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from hashlib import sha256
from io import StringIO
from itertools import cycle
from pathlib import Path

from debrisest.cli import app
from debrisest.results import store

CONFIG = Path(__file__).parent.parent / "tests" / "scenarios" / "small.yaml"
CODES = {signal.SIGKILL: -9, signal.SIGTERM: 143, signal.SIGINT: 130}
SENTENCE = "interrupted: finished steps are kept"
PATIENCE_S, START_S = 5.0, 120.0
ADDRESS = "tcp://127.0.0.1:18786"
Machine = Sequence[str]


def main(times: dict[signal.Signals, int], seed: int, machines: Sequence[Machine]) -> int:
    """Return how many sweeps were not ended as they should be."""
    generator, all_wrong = random.Random(seed), 0
    with tempfile.TemporaryDirectory() as folder:
        lasts = {machine: whole(Path(folder) / "-".join(machine), machine) for machine in machines}
        expected = content(Path(folder) / "-".join(machines[0]))
        for number, count in times.items():
            wrong = early = 0
            for turn, machine in zip(range(count), cycle(machines)):
                out = Path(folder) / f"{number}-{turn}"
                delay = generator.uniform(0.02, lasts[machine])
                finished, said = ended(out, machine, number, delay)
                go_on(out)
                said += ["left a temporary file"] * bool(list(out.rglob(".*.tmp")))
                said += ["other tables or data"] * (content(out) != expected)
                if said:
                    after = f"{number.name}, {' '.join(machine)}, after {delay:.3f} s:"
                    print(after, *said, flush=True)
                wrong, early = wrong + bool(said), early + finished
                if turn % 10 == 9 or turn == count - 1:
                    told = f"{turn + 1} sweeps, {wrong} wrong, {early} over before"
                    print(f"{number.name}: {told}", flush=True)
            all_wrong += wrong
    return all_wrong


def whole(out: Path, machine: Machine) -> float:
    """Return how many seconds an undisturbed sweep takes."""
    began = time.monotonic()
    if swept(out, machine).wait():
        raise SystemExit(f"the undisturbed sweep failed: {' '.join(machine)}")
    return time.monotonic() - began


def ended(
    out: Path, machine: Machine, number: signal.Signals, delay: float
) -> tuple[bool, list[str]]:
    """Send a signal to a sweep after a delay; return whether it was over, and what is wrong."""
    mark = f"{os.getpid()}-{out.name}"
    process = swept(out, machine, mark)
    time.sleep(delay)
    finished = process.poll() is not None or (out / "small" / "tables.csv").exists()
    codes = {CODES[number]} if listens(process.pid) else {CODES[number], -number}
    process.send_signal(number)
    told = process.communicate()[1]
    wrong = [f"a trace:\n{told}"] if "Traceback" in told else []
    if not finished and process.returncode not in codes:
        wrong.append(f"exit code {process.returncode}")
    if not finished and process.returncode != -number and SENTENCE not in told:
        wrong.append(f"did not say so: {told[-200:]!r}")
    end = time.monotonic() + PATIENCE_S
    while left := running(mark):
        if time.monotonic() > end:
            return finished, [*wrong, f"left running: {left}"]
        time.sleep(0.05)
    return finished, wrong


def swept(out: Path, machine: Machine, mark: str = "") -> subprocess.Popen[str]:
    """Start a sweep whose processes can be found by a mark."""
    command = [sys.executable, "-m", "debrisest", "sweep", str(CONFIG), "--out", str(out)]
    return subprocess.Popen(
        [*command, *machine],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE if mark else subprocess.DEVNULL,
        text=True,
        env=os.environ | {"INTERRUPTED_SWEEP": mark},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def listens(process: int) -> bool:
    """Return whether a process (Linux) has got past the start of Python, which ends unheard."""
    with suppress(OSError):
        status = Path(f"/proc/{process}/status").read_text()
        caught = int(status.partition("SigCgt:")[2].split()[0], 16)
        return bool(caught >> (signal.SIGTERM - 1) & 1)
    return False


def go_on(out: Path) -> None:
    """Bring a sweep to its end, in this process."""
    with redirect_stdout(StringIO()), suppress(SystemExit):
        app(["sweep", str(CONFIG), "--out", str(out), "--jobs", "1", "--quiet"])


def running(mark: str) -> list[str]:
    """Return the processes (Linux) that carry a mark."""
    wanted = f"INTERRUPTED_SWEEP={mark}\0".encode()
    found = []
    for path in Path("/proc").glob("[0-9]*/environ"):
        try:
            if wanted in path.read_bytes():
                found.append(path.parent.name)
        except OSError:
            continue
    return found


def content(out: Path) -> str:
    """Return a digest of the tables and of all data of a sweep."""
    told = sha256((out / "small" / "tables.csv").read_bytes())
    for path in sorted(out.rglob("*.h5")):
        told.update(str(path.relative_to(out)).encode())
        for name, values in sorted(store.read(path).items()):
            told.update(name.encode() + values.tobytes())
    return told.hexdigest()


@contextmanager
def cluster() -> Iterator[None]:
    """Run a dask scheduler and a worker, and wait until it is known."""
    from distributed import Client

    port = ADDRESS.rpartition(":")[2]
    commands = (
        ("scheduler", "--host", "127.0.0.1", "--port", port, "--no-dashboard"),
        ("worker", ADDRESS, "--nworkers", "1", "--nthreads", "1", "--no-dashboard"),
    )
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    started = [
        subprocess.Popen([sys.executable, "-m", "dask", *each], **quiet) for each in commands
    ]
    try:
        with Client(ADDRESS, timeout=START_S) as client:
            client.wait_for_workers(1, timeout=START_S)
        yield
    finally:
        for process in reversed(started):
            process.terminate()
            process.wait()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    for name in ("kill", "term", "int"):
        parser.add_argument(f"--{name}", type=int, default=30, metavar="TIMES")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--dask", action="store_true", help="on a cluster too")
    asked = parser.parse_args()
    counts = {number: getattr(asked, number.name[3:].lower()) for number in CODES}
    local = (("--jobs", "1"), ("--jobs", "2"))
    if asked.dask:
        with cluster():
            failed = main(counts, asked.seed, (*local, ("--executor", f"dask:{ADDRESS}")))
    else:
        failed = main(counts, asked.seed, local)
    sys.exit(min(failed, 1))
