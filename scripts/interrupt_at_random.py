"""End sweeps at random moments by SIGKILL, SIGTERM and SIGINT, and tell what is wrong afterwards.

    python scripts/interrupt_at_random.py [TIMES [SEED]]

Each sweep is ended once, with one job and with two in turn, and then brought to its end: nothing
may be left running, nobody may see a trace, and the tables must be those of an undisturbed sweep.
"""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CONFIG = Path(__file__).parent.parent / "tests" / "scenarios" / "small.yaml"
CODES = {signal.SIGKILL: -9, signal.SIGTERM: 143, signal.SIGINT: 130}
SENTENCE = "interrupted: finished steps are kept"
PATIENCE_S = 5.0


def main(times: int, seed: int) -> int:
    """Return how many sweeps were not ended as they should be."""
    generator, wrong = random.Random(seed), 0
    with tempfile.TemporaryDirectory() as folder:
        began = time.monotonic()
        swept(Path(folder) / "reference", 2).wait()
        whole = time.monotonic() - began
        expected = tables(Path(folder) / "reference")
        for number in CODES:
            for turn in range(times):
                out, delay = Path(folder) / f"{number}-{turn}", generator.uniform(0.05, whole)
                said = ended(out, 1 + turn % 2, number, delay)
                swept(out, 1).wait()
                if tables(out) != expected:
                    said.append("other tables")
                if said:
                    print(f"{number.name}, {1 + turn % 2} jobs, after {delay:.3f} s:", *said)
                wrong += bool(said)
            print(f"{number.name}: {times} done, {wrong} wrong so far", flush=True)
    return wrong


def ended(out: Path, jobs: int, number: signal.Signals, delay: float) -> list[str]:
    """Send a signal to a sweep after a delay; return what is wrong with how it ended."""
    mark = f"{os.getpid()}-{out.name}"
    process = swept(out, jobs, mark)
    time.sleep(delay)
    finished = process.poll() is not None or (out / "small" / "tables.csv").exists()
    process.send_signal(number)
    told = process.communicate()[1]
    wrong = [f"a trace:\n{told}"] if "Traceback" in told else []
    if not finished and process.returncode != CODES[number]:
        wrong.append(f"exit code {process.returncode}")
    if not finished and number != signal.SIGKILL and SENTENCE not in told:
        wrong.append("said nothing")
    end = time.monotonic() + PATIENCE_S
    while left := running(mark):
        if time.monotonic() > end:
            return [*wrong, f"left running: {left}"]
        time.sleep(0.05)
    return wrong


def swept(out: Path, jobs: int, mark: str = "") -> subprocess.Popen[str]:
    """Start a sweep whose processes can be found by a mark."""
    command = [sys.executable, "-m", "debrisest", "sweep", str(CONFIG), "--out", str(out)]
    return subprocess.Popen(
        [*command, "--jobs", str(jobs)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE if mark else subprocess.DEVNULL,
        text=True,
        env=os.environ | {"INTERRUPTED_SWEEP": mark},
    )


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


def tables(out: Path) -> bytes:
    """Return the tables of a sweep."""
    return (out / "small" / "tables.csv").read_bytes()


if __name__ == "__main__":
    times, seed = ([int(text) for text in sys.argv[1:]] + [30, 1][len(sys.argv) - 1 :])[:2]
    sys.exit(min(main(times, seed), 1))
