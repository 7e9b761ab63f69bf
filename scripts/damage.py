"""Damage files of results at random and count what the commands make of it.

    python scripts/damage.py [--seed 1] [--count 40] [--runs 3] [--files 3] [--skip 0]

It sweeps one case of the small scenario of the tests (more RUNS make larger files), damages FILES
of its files (COUNT times each: bytes, a bit, the end, the structure as h5py edits it, also under a
new seal; then every page), and after each asks for the status and the tables, and sweeps, within
two seconds of CPU and 64 MB. Most are asked for by the functions that the commands call, one in 20
by the command line, one in 250 by a process of its own. It prints, for each file and kind of
damage, how many there were, and how many ended in a trace, a hang, or wrong tables before the sweep
or after it; these files are kept. ``--skip`` leaves out files that were damaged before.
"""

import argparse
import faulthandler
import io
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import h5py
import numpy as np

from debrisest.cli import app
from debrisest.errors import UserError
from debrisest.files import put
from debrisest.results import store
from debrisest.results.open import find_results
from debrisest.results.overview import overview
from debrisest.results.sealed import read_image, read_label, sealed
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.sweep import Machine, bring_up_to_date
from debrisest.scenario.document import parse, text_of
from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.show.tables.render import render
from debrisest.show.tables.tabulate import read_by_tables, tabulate

CONFIG = Path(__file__).parent.parent / "tests" / "scenarios" / "small.yaml"
PAGE, LIMIT_S, ROOM_BYTES = 4096, 2, 64 * 2**20
WATCH_S = 60
FEW, FEWEST = 20, 250
"""Of so many damages one is met by the command line, and by processes of their own."""
HANG, TRACE = "hang", "trace"
Damage = Callable[[Path], object]


def damages_of(
    path: Path, rng: np.random.Generator, count: int, page: int
) -> Iterator[tuple[str, Damage]]:
    """Yield kinds of damage to a file: random ones, then every page."""
    size = path.stat().st_size
    for _ in range(count):
        yield "bytes", _overwriting(int(rng.integers(size)), rng.bytes(int(rng.integers(1, 9))))
        yield "bit", _flipping(int(rng.integers(size)), 1 << int(rng.integers(8)))
        yield "truncated", _truncating(int(rng.integers(size)))
        yield "structure", _editing(rng)
        yield "structure under a seal", _resealing(rng)
    for start in range(0, size, page):
        yield "page of zeros", _overwriting(start, bytes(min(page, size - start)))
        yield "page of noise", _overwriting(start, rng.bytes(min(page, size - start)))


def _overwriting(start: int, content: bytes) -> Damage:
    def damage(path: Path) -> None:
        with path.open("r+b") as file:
            file.seek(start)
            file.write(content)

    return damage


def _flipping(at: int, mask: int) -> Damage:
    return lambda path: _overwriting(at, bytes([path.read_bytes()[at] ^ mask]))(path)


def _truncating(length: int) -> Damage:
    return lambda path: path.write_bytes(path.read_bytes()[:length])


def _editing(rng: np.random.Generator) -> Damage:
    def damage(path: Path) -> None:
        with h5py.File(path, "r+") as file:
            edit = EDITS[int(rng.integers(len(EDITS)))]
            edit(file, str(rng.choice(list(file))), str(rng.choice(list(file.attrs))))

    return damage


def _resealing(rng: np.random.Generator) -> Damage:
    """Edit a file's datasets or attributes, and seal it again as if it had been written so."""

    def damage(path: Path) -> None:
        with path.open("rb") as file:
            label = read_label(file)
            assert label is not None
            image, attributes = io.BytesIO(read_image(file, label) or b""), dict(label.attributes)
        if rng.random() < 0.5:
            with h5py.File(image, "r+") as opened:
                edit = STRUCTURE[int(rng.integers(len(STRUCTURE)))]
                edit(opened, str(rng.choice(list(opened))), "format")
        else:
            key = str(rng.choice(list(attributes)))
            value = ODD[int(rng.integers(len(ODD)))]
            attributes |= {key: value}
            if value is None:
                del attributes[key]
        path.write_bytes(sealed(image.getvalue(), attributes))

    return damage


def _replace(file: Any, name: str, value: Any) -> None:
    del file[name]
    file[name] = value


ODD = (
    None,
    7.5,
    "other",
    "",
    [],
    {},
    -1,
    0,
    True,
    10**30,
    float("nan"),
    "[]",
    "{}",
    "1",
    "[" * 9999,
)
"""Values for an attribute; None takes it away."""
STRUCTURE: list[Callable[[Any, str, str], object]] = [
    lambda file, name, _: file.pop(name),
    lambda file, name, _: file.move(name, f"{name}_moved"),
    lambda file, name, _: _replace(file, name, np.zeros(3)),
    lambda file, name, _: _replace(file, name, "words"),
    lambda file, name, _: _replace(file, name, h5py.ExternalLink("other.h5", name)),
    lambda file, name, _: _replace(file, name, h5py.SoftLink("/run")),
    lambda file, name, _: file[name].attrs.update({"units": "km"}),
    lambda file, name, _: file[name].attrs.update({"units": np.arange(3)}),
    lambda file, name, _: file[name].attrs.pop("units"),
    lambda file, name, _: _replace(file, name, h5py.Empty("f8")),
    lambda file, name, _: _replace(file, name, file[name][:1]),
    lambda file, name, _: file.create_group("group"),
]
"""Edits of the structure that no seal hides."""
EDITS = [
    *STRUCTURE,
    lambda file, name, _: file[name].write_direct(np.ones(file[name].shape)),
    lambda file, _, key: file.attrs.pop(key),
    lambda file, _, key: file.attrs.update({key: 7.5}),
    lambda file, _, key: file.attrs.update({key: "other"}),
]


def attempt(call: Callable[[], object]) -> str:
    """Call within the time that there is; return a trace or a hang in a word."""
    signal.signal(signal.SIGVTALRM, _stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, LIMIT_S)
    try:
        call()
    except (SystemExit, UserError):
        return ""
    except TimeoutError:
        return HANG
    except Exception:
        traceback.print_exc()
        return TRACE
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return ""


def run(*arguments: object) -> tuple[str, str]:
    """Run a command; return what it printed, and a trace or a hang in a word."""
    printed, told = io.StringIO(), io.StringIO()

    def call() -> None:
        with redirect_stdout(printed), redirect_stderr(told):
            app([str(argument) for argument in arguments])

    ended = attempt(call)
    return printed.getvalue(), ended or TRACE * ("Traceback" in told.getvalue())


def _stop(*_: object) -> None:
    raise TimeoutError


def _by_itself(*arguments: object) -> str:
    """Run a command in a process of its own; return a trace or a hang in a word."""
    words = [sys.executable, "-m", "debrisest", *map(str, arguments)]
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=WATCH_S)
    except subprocess.TimeoutExpired:
        return HANG
    return TRACE * ("Traceback" in done.stderr or done.returncode < 0)


class Swept(NamedTuple):
    """A scenario whose results are whole, but for one file at a time."""

    config: Path
    out: Path

    def commands(self, number: int) -> list[Callable[[], str]]:
        """Return what asks for the status, for the tables, and sweeps; each returns a word."""
        if number % FEWEST and number % FEW:
            return [partial(attempt, call) for call in (self._status, self._tables, self._sweep)]
        own, some = not number % FEWEST, (self.config, "--out", self.out)
        asked = [("status", *some), ("table", *some), ("sweep", *some, "--jobs", 1, "--quiet")]
        return [partial(_by_itself, *each) if own else partial(_ended, *each) for each in asked]

    @property
    def scenario(self) -> LoadedScenario:
        """Return the scenario, read once."""
        return _loaded(self.config)

    def _status(self) -> None:
        steps = plan(self.scenario, self.out, Selection())
        rows = overview(find_results(self.out / self.scenario.name), steps)
        assert all(row.lines() for row in rows)

    def _tables(self) -> None:
        shown = read_by_tables(self.scenario)
        rows, _ = tabulate(
            self.scenario, self.out, plan(self.scenario, self.out, Selection(), shown)
        )
        if not rows.empty:
            put(
                self.out / self.scenario.name / "tables.csv",
                render(self.scenario, rows, "csv").encode(),
            )

    def _sweep(self) -> None:
        with redirect_stderr(io.StringIO()):
            bring_up_to_date([self.scenario], self.out, Selection(), Machine(quiet=True))
        self._tables()


@cache
def _loaded(config: Path) -> LoadedScenario:
    return load_scenario(config)


def _ended(*arguments: object) -> str:
    return run(*arguments)[1]


def reduced(folder: Path, runs: int = 3) -> Path:
    """Write the small scenario with one case, one estimator and one table; return its path."""
    value = parse(CONFIG.read_text(), CONFIG.name)[0].value | {"runs": runs}
    del value["estimators"]["wahba"], value["cases"]["fast"], value["tables"]["means"]
    del value["tables"]["published"], value["tables"]["layout"][0], value["tables"]["layout"][1]
    path = folder / CONFIG.name
    path.write_text(text_of(value))
    return path


@contextmanager
def limited() -> Iterator[None]:
    """Refuse memory far beyond what a command takes."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + ROOM_BYTES, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


def tally(
    config: Path, out: Path, seed: int, count: int, files: int, page: int = PAGE, skip: int = 0
) -> Counter[tuple[str, str]]:
    """Return how many damages of each kind ended how; ``out`` holds whole results before."""
    every = Counter[tuple[str, str]]()
    there = sorted(out.rglob("slow/*.h5"))
    chosen = np.random.default_rng(seed).permutation(len(there))[skip:files]
    for index in chosen:
        rng = np.random.default_rng((seed, index))
        every += _of_file(
            Swept(config, out), there[index], damages_of(there[index], rng, count, page)
        )
    return every


def _of_file(
    swept: Swept, path: Path, each: Iterable[tuple[str, Damage]]
) -> Counter[tuple[str, str]]:
    """Damage one file in each way, and return what came of it."""
    content, found, began = path.read_bytes(), Counter[tuple[str, str]](), time.monotonic()
    right = (swept.out / swept.config.stem / "tables.csv").read_bytes()
    for number, (kind, damage) in enumerate(each, 1):
        with suppress(TypeError, ValueError, KeyError, OSError, RuntimeError):
            damage(path)
        damaged = path.read_bytes()
        faulthandler.dump_traceback_later(4 * WATCH_S, exit=True)
        store._labelled.cache_clear()
        store._is_sealed.cache_clear()
        wrong = list(_outcomes(swept, number, right))
        faulthandler.cancel_dump_traceback_later()
        found.update([(kind, "all"), *((kind, how) for how in wrong)])
        if wrong:
            _keep(path, number, kind, wrong, damaged)
        path.write_bytes(content)
        if number % 200 == 0:
            _tell(path, number, found, began)
    _tell(path, number, found, began)
    return found


def _keep(path: Path, number: int, kind: str, wrong: list[str], damaged: bytes) -> None:
    """Tell of a damage that ended wrong, and keep the file as it was then."""
    kept = Path(tempfile.mkdtemp(prefix="wrong-damage-")) / path.name
    kept.write_bytes(damaged)
    print(path.name, number, kind, *wrong, kept, flush=True)


def _tell(path: Path, number: int, found: Counter[tuple[str, str]], began: float) -> None:
    wrong = {words: times for words, times in found.items() if words[1] != "all"}
    each = (time.monotonic() - began) / number
    print(f"{path.name}: {number} damages, wrong {wrong or 0}, {each:.3f} s each", flush=True)


def _outcomes(swept: Swept, number: int, right: bytes) -> Iterator[str]:
    """Yield what went wrong: before the sweep a table may have fewer cells, but no wrong one."""
    table = swept.out / swept.config.stem / "tables.csv"
    status, tables, sweep = swept.commands(number)
    ended = [status(), tables()]
    cells = set(table.read_bytes().splitlines())
    if not {line for line in cells if b"slow" in line} <= set(right.splitlines()):
        yield "wrong before"
    ended.append(sweep())
    yield from filter(None, ended)
    if table.read_bytes() != right:
        yield "wrong"


def main() -> int:
    """Print the counts of all kinds; return 1 if any ended wrong."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    for name, usual in {"seed": 1, "count": 40, "runs": 3, "files": 3, "skip": 0}.items():
        parser.add_argument(f"--{name}", type=int, default=usual)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        config, out = reduced(Path(folder), asked.runs), Path(folder) / "out"
        for command in ("sweep", "status", "table"):
            run(command, config, "--out", out)
        with limited():
            found = tally(config, out, asked.seed, asked.count, asked.files, skip=asked.skip)
    for kind in dict.fromkeys(kind for kind, _ in found):
        print(kind, {how: number for (of, how), number in found.items() if of == kind})
    return int(any(how != "all" for _, how in found))


if __name__ == "__main__":
    sys.exit(main())
