"""Mutate texts that people write at random, and count what the commands make of them.

    python scripts/mutate.py [--seed 1] [--count 100] [--kinds yaml published tracks poses accepted]

Scenarios and published values go through ``validate``, tracks and poses through ``import``, and of
``accepted`` each scenario that is still valid with an odd value through all stages. It prints what
ended in a trace, a warning, a hang, or as a mistake of the program, with how it can be seen again.
"""

import argparse
import re
import runpy
import shutil
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from debrisest.results import store

HERE = Path(__file__).parent
SMALL = HERE.parent / "tests" / "scenarios"
EXAMPLES = HERE.parent / "configs" / "examples"
KINDS = ("yaml", "published", "tracks", "poses", "accepted")
ODD = (
    "0", "-1", "1e-30", "1e-10", "1e10", "1e19", "1e300", "-1e-9", "nan", ".inf", "true", "null",
    "~", "[]", "{}", "[1, 2]", "''", '"\\ud83d"', "'='", "x", "*x", "&x 1", "!!python/none", "0x1F",
    "1_000", "12:30", "2020-01-01", "99999999999999999999", "[[[[]]]]", "{kind: none}", "|", "?",
)  # fmt: skip
PIECES = (":", "- ", "\t", "  ", "#", "{", "}", "[", "]", ",", '"', "'", "\0", "\x1b[2J", "é", "\n")


def mutations(text: str, rng: np.random.Generator) -> str:
    """Return a text with one to three changes."""
    for _ in range(int(rng.integers(1, 4))):
        text = CHANGES[int(rng.integers(len(CHANGES)))](text, rng)
    return text


def _odd(text: str, rng: np.random.Generator) -> str:
    """Replace a number or a word."""
    found = list(re.finditer(r"[-+]?\d[\d.e+-]*|[A-Za-z_]\w*", text))
    if not found:
        return text
    one = found[int(rng.integers(len(found)))]
    return text[: one.start()] + str(rng.choice(ODD)) + text[one.end() :]


def _odd_number(text: str, rng: np.random.Generator) -> str:
    """Replace a number by another one."""
    found = list(re.finditer(r"(?<![\w.])[-+]?\d[\d.]*(?:e[+-]?\d+)?(?![\w.])", text))
    one = found[int(rng.integers(len(found)))]
    return text[: one.start()] + str(rng.choice(ODD[:8])) + text[one.end() :]


def _cut(text: str, rng: np.random.Generator) -> str:
    first, last = sorted(rng.integers(len(text) + 1, size=2).tolist())
    return text[:first] + text[min(last, first + 40) :]


def _insert(text: str, rng: np.random.Generator) -> str:
    at = int(rng.integers(len(text) + 1))
    return text[:at] + str(rng.choice(PIECES)) + text[at:]


def _move_line(text: str, rng: np.random.Generator) -> str:
    lines = text.splitlines(keepends=True) or [""]
    line = lines[int(rng.integers(len(lines)))]
    lines.insert(int(rng.integers(len(lines) + 1)), line)
    return "".join(lines)


def _end(text: str, rng: np.random.Generator) -> str:
    return text[: int(rng.integers(len(text) + 1))]


CHANGES = (_odd, _odd, _odd, _cut, _insert, _move_line, _end)


def tally(kind: str, seed: int, count: int, folder: Path) -> Counter[str]:
    """Return how many mutations of a kind ended how, printing those that ended wrong."""
    run = runpy.run_path(str(HERE / "damage.py"))["run"]
    rng, found = np.random.default_rng(seed), Counter[str]()
    for name in ("small.yaml", "small.csv"):
        shutil.copy(SMALL / name, folder)
    for number in range(count):
        wrong = list(_wrong(kind, rng, folder, run))
        found["all"] += 1
        found.update(wrong)
        if wrong:
            kept = folder.parent / f"wrong-{kind}-{seed}-{number}"
            shutil.copytree(folder, kept, dirs_exist_ok=True)
            print(kind, seed, number, *wrong, kept, flush=True)
    return found


def _wrong(kind: str, rng: np.random.Generator, folder: Path, run: Any) -> Iterator[str]:
    """Mutate one text, and yield what is wrong with how it ends."""
    source = SMALL / "small.csv" if kind == "published" else SMALL / "small.yaml"
    source = EXAMPLES / f"{kind}.csv" if kind in ("tracks", "poses") else source
    lines = source.read_text().splitlines(keepends=True)[:400]
    change = _odd_number if kind == "accepted" else mutations
    path = folder / source.name
    path.write_text(change("".join(lines), rng), encoding="utf-8", errors="surrogatepass")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if kind in ("tracks", "poses"):
            yield from filter(None, [run("import", path, "--force")[1]])
            return
        told, ended = run("validate", folder / "small.yaml")
        yield from filter(None, [ended])
        if kind == "accepted" and told:
            yield from _through_all_stages(folder, run)


def _through_all_stages(folder: Path, run: Any) -> Iterator[str]:
    out = folder / "out"
    shutil.rmtree(out, ignore_errors=True)
    options = ("--runs", 2, "--case", "slow", "--estimator", "triad", "--jobs", 1, "--quiet")
    yield from filter(None, [run("sweep", folder / "small.yaml", "--out", out, *options)[1]])
    for path in out.rglob("*.h5"):
        for why in store.read(path).get("failure", ()):
            if re.search("(Error|Warning): ", why):
                yield why


def main() -> int:
    """Print the counts of all kinds; return 1 if any ended wrong."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--kinds", nargs="+", default=KINDS, choices=KINDS)
    asked, wrong = parser.parse_args(), 0
    for kind in asked.kinds:
        folder = Path(tempfile.mkdtemp()) / "now"
        folder.mkdir()
        found = tally(kind, asked.seed, asked.count, folder)
        print(kind, dict(found), flush=True)
        wrong += len(found) > 1
        shutil.rmtree(folder.parent if len(found) == 1 else folder)
    return min(wrong, 1)


if __name__ == "__main__":
    sys.exit(main())
