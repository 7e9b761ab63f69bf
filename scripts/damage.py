"""Damage files of results at random and count what the commands make of it.

``python scripts/damage.py [SEED] [COUNT] [RUNS]`` sweeps one case of the small scenario of
the tests (more RUNS make larger files), damages three files (COUNT times each: bytes, a bit, the
end, the structure as h5py edits it, also under a new seal; then every page), and runs ``status``,
``table`` and ``sweep`` after each, within two seconds of CPU and 64 MB. It prints, for each kind of
damage, how many there were, and how many ended in a trace, a hang, or wrong tables before the sweep
or after it.
"""

import faulthandler
import io
import resource
import signal
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from debrisest.cli import app
from debrisest.results.sealed import read_image, read_label, sealed
from debrisest.scenario.document import parse, text_of

CONFIG = Path(__file__).parent.parent / "tests" / "scenarios" / "small.yaml"
PAGE, LIMIT_S, ROOM_BYTES = 4096, 2, 64 * 2**20
HANG = "hang"
Damage = Callable[[Path], object]


def damages(
    rng: np.random.Generator, size: int, count: int, page: int
) -> Iterator[tuple[str, Damage]]:
    """Yield kinds of damage to a file of ``size`` bytes: random ones, then every page."""
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


def run(*arguments: object) -> tuple[str, str]:
    """Run a command; return what it printed, and a trace or a hang in a word."""
    printed, told = io.StringIO(), io.StringIO()
    signal.signal(signal.SIGVTALRM, _stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, LIMIT_S)
    try:
        with redirect_stdout(printed), redirect_stderr(told):
            app([str(argument) for argument in arguments])
    except SystemExit:
        return printed.getvalue(), "trace" if "Traceback" in told.getvalue() else ""
    except TimeoutError:
        return "", HANG
    except Exception:
        traceback.print_exc()
        return "", "trace"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return printed.getvalue(), ""


def _stop(*_: object) -> None:
    raise TimeoutError


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
    config: Path, out: Path, seed: int, count: int, files: int, page: int = PAGE
) -> Counter[tuple[str, str]]:
    """Return how many damages of each kind ended how; ``out`` holds whole results before."""
    rng = np.random.default_rng(seed)
    table = out / config.stem / "tables.csv"
    right, found = table.read_bytes(), Counter[tuple[str, str]]()
    there = sorted(out.rglob("slow/*.h5"))
    for path in (there[index] for index in rng.permutation(len(there))[:files]):
        content = path.read_bytes()
        for kind, damage in damages(rng, len(content), count, page):
            with suppress(TypeError, ValueError, KeyError, OSError, RuntimeError):
                damage(path)
            found[kind, "all"] += 1
            faulthandler.dump_traceback_later(60, exit=True)
            found.update((kind, how) for how in _outcomes(config, out, table, right))
            faulthandler.cancel_dump_traceback_later()
            path.write_bytes(content)
        print(path.name, len(content), "bytes", dict(found), file=sys.stderr, flush=True)
    return found


def _outcomes(config: Path, out: Path, table: Path, right: bytes) -> Iterator[str]:
    """Yield what went wrong: before the sweep a table may have fewer cells, but no wrong one."""
    some = ("--out", out)
    ended = [run(command, config, *some)[1] for command in ("status", "table")]
    cells = set(table.read_bytes().splitlines())
    if not {line for line in cells if b"slow" in line} <= set(right.splitlines()):
        yield "wrong before"
    ended.append(run("sweep", config, *some, "--jobs", 1, "--quiet")[1])
    yield from filter(None, ended)
    if table.read_bytes() != right:
        yield "wrong"


def main() -> None:
    """Print the counts of all kinds."""
    given = sys.argv[1:]
    seed, count, runs = (int(text) for text in [*given, *("1", "40", "3")[len(given) :]])
    with tempfile.TemporaryDirectory() as folder:
        config, out = reduced(Path(folder), runs), Path(folder) / "out"
        for command in ("sweep", "status", "table"):
            run(command, config, "--out", out)
        with limited():
            found = tally(config, out, seed, count, files=3)
    for kind in dict.fromkeys(kind for kind, _ in found):
        print(kind, {how: number for (of, how), number in found.items() if of == kind})


if __name__ == "__main__":
    main()
