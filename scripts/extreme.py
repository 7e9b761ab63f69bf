"""Give every numeric key of every part extreme values, and run what is accepted through all stages.

    python scripts/extreme.py [--seed 1] [--worlds 24] [--count 2000]

The scenarios are those that the tests draw from the catalog (``tests/worlds.py``), others with each
seed. It prints what ended in a trace, a numpy warning, a hang, or in a reason that names no part,
with key and value.
"""

import argparse
import os
import random
import re
import resource
import signal
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from debrisest.errors import UserError  # noqa: E402
from debrisest.runner.plan import plan  # noqa: E402
from debrisest.runner.selection import Selection  # noqa: E402
from debrisest.runner.sweep import Machine, bring_up_to_date  # noqa: E402
from debrisest.scenario.document import KeyPath, parse, text_of  # noqa: E402
from debrisest.scenario.load import load_scenario  # noqa: E402
from debrisest.scenario.resolved import resolved  # noqa: E402
from debrisest.show.tables.tabulate import tabulate  # noqa: E402
from tests.worlds import World, loaded  # noqa: E402

EXTREME = (
    0, -1, 1, -0.0, 5e-324, 1e-30, 1e-15, 1e-9, 1e-3, -1e-9, 1e3, 1e5, 1e6, 1e9, 1e12, 1e15, 1e19,
    -1e5, -1e12, 1e300, float("nan"), float("inf"),
)  # fmt: skip
ELSEWHERE = ("tables", "runs", "duration_s", "step_s")
"""Keys whose large values mean long work."""
LIMIT_S, ROOM_BYTES = 20, 3 * 2**30
BARE = re.compile(r"(Error|Warning): ")


def leaves(value: Any, path: KeyPath = (), kind: str = "") -> Iterator[tuple[KeyPath, str]]:
    """Yield the paths of all numbers of plain data, and a name that the same keys share."""
    if isinstance(value, dict):
        kind = str(value.get("kind", kind))
        for key, inner in value.items():
            yield from leaves(inner, (*path, key), kind)
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from leaves(inner, (*path, index), kind)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        names = [key for key in path if isinstance(key, str)]
        yield path, f"{path[0]} {kind} {names[-1]} {path[-1]}"


def changed(value: Any, path: KeyPath, new: Any) -> Any:
    """Return plain data with another value at a path."""
    if not path:
        return new
    key: Any = path[0]
    copy = value.copy()
    copy[key] = changed(copy[key], path[1:], new)
    return copy


def variants(seed: int, done: set[tuple[str, str]], folder: Path) -> Iterator[tuple[str, Any]]:
    """Yield scenarios of a world with one extreme value each, that were in none before."""
    scenario = loaded(folder / "world.yaml", World(seed).scenario(12))
    if scenario is None:
        return
    base = parse(resolved(next(iter(scenario.cases.values()))), "")[0].value
    base["tables"]["layout"] = base["tables"]["layout"][:1]
    every = base["estimators"]
    for path, name in leaves({key: v for key, v in base.items() if key not in ELSEWHERE}):
        own = path[1:2] if path[0] == "estimators" else [*every][:2]
        few = changed(base, ("estimators",), {key: every[key] for key in own})
        for key in few["estimators"]:
            few["estimators"][key] = {k: v for k, v in every[key].items() if k != "bound"}
        for new in EXTREME:
            if (name, str(new)) not in done:
                done.add((name, str(new)))
                yield f"world {seed}, {'.'.join(map(str, path))}: {new}", changed(few, path, new)


def outcome(scenario: Any, folder: Path) -> tuple[str, list[str]]:
    """Return whether a scenario was refused or run, and what was wrong with how it went."""
    path = folder / "now.yaml"
    path.write_text(text_of(scenario))
    signal.signal(signal.SIGVTALRM, _stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, LIMIT_S)
    out = Path(tempfile.mkdtemp(dir=folder))
    ended = "refused"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            found = load_scenario(path)
            ended = "run"
            failed = bring_up_to_date([found], out, Selection(), Machine(quiet=True))
            tabulate(found, out, plan(found, out, Selection()))
            wrong = [f"{where}: {why}" for where, why in failed.items() if BARE.search(why)]
        except UserError as error:
            wrong = [f"late: {error}"] if ended == "run" else []
        except Hang:
            wrong = ["hang"]
        except Exception as error:
            wrong = [f"trace: {type(error).__name__}: {error}"]
        finally:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    places = {f"warning: {w.message} ({Path(w.filename).name}:{w.lineno})" for w in caught}
    return ended, [*wrong, *sorted(places)]


class Hang(BaseException):
    """No handler of ordinary errors takes it for a run that failed."""


def _stop(*_: object) -> None:
    raise Hang


def main() -> int:
    """Print what is wrong and the counts; return 1 if anything was."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--worlds", type=int, default=24)
    parser.add_argument("--count", type=int, default=2000, help="of accepted values, at most")
    asked = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (ROOM_BYTES, ROOM_BYTES))
    counts, done = Counter[str](), set[tuple[str, str]]()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        worlds = range(asked.seed * asked.worlds, (asked.seed + 1) * asked.worlds)
        every = [one for world in worlds for one in variants(world, done, folder)]
        random.Random(asked.seed).shuffle(every)
        for number, (said, scenario) in enumerate(every):
            ended, wrong = outcome(scenario, folder)
            counts.update([ended, *["wrong"] * bool(wrong)])
            for one in wrong[:3]:
                print(f"{said} -> {one[:400]}", flush=True)
            if number % 100 == 0:
                print(number, "of", len(every), dict(counts), flush=True)
            if counts["run"] == asked.count:
                break
    print(dict(counts))
    return min(counts["wrong"], 1)


if __name__ == "__main__":
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.exit(main())
