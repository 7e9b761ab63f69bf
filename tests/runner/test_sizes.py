"""Tables do not depend on how many runs a file holds, on the processes, or on an interruption."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from debrisest.results import store, trajectories
from debrisest.runner import cut

RUNS = ("--case", "slow", "--runs", 23)


@pytest.fixture(scope="module")
def by_two(tmp_path_factory: pytest.TempPathFactory, process: Callable) -> bytes:
    """The tables that two processes make, 20 runs to a file."""
    out, config = tmp_path_factory.mktemp("two"), Path(__file__).parents[1] / "scenarios/small.yaml"
    running = process("sweep", config, "--out", out, "--jobs", 2, *RUNS)
    _, told = running.communicate(timeout=120)
    assert running.returncode == 0, told
    return tables(out)


def tables(out: Path) -> bytes:
    return (out / "small" / "tables.csv").read_bytes()


@pytest.mark.parametrize("size", [7, 20, 100])
@pytest.mark.parametrize("written", [0, 3, 8])
def test_any_size_interrupted_anywhere(
    size: int, written: int, small: Path, tmp_path: Path, sweep: Callable, by_two: bytes,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr(cut, "RUNS_PER_FILE", size)
    monkeypatch.setattr(trajectories, "_SMALL", 0)
    original, left = store.write, [None] * written

    def interrupted(*arguments: Any) -> None:
        if not left:
            raise KeyboardInterrupt
        left.pop()
        original(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(store, "write", interrupted)
        interruption = sweep(small, tmp_path / "out", *RUNS)
    assert interruption.exit_code == (0 if left else 130)
    assert sweep(small, tmp_path / "out", *RUNS).exit_code == 0
    assert tables(tmp_path / "out") == by_two
