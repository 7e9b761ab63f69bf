"""Runs that failed or diverged are computed again where that is asked for, and no others."""

from collections.abc import Callable
from pathlib import Path

import pytest

from debrisest.parts.recoveries.basis_pursuit import BasisPursuit

ONE = ("--case", "slow")
LIMITED = "tables.diverged=[{quantity: pitch, above: 1e-6, window: 40-60 s}]"


def would_run(told: str) -> list[str]:
    return [line.partition(",")[0] for line in told.splitlines()[:-1]]


def test_a_failed_run_is_tried_again(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    original = BasisPursuit.recover

    def broken(self: BasisPursuit, data: dict, clock: object) -> dict:
        if self.attitude == "triad" and 1 in data["run"]:
            raise ArithmeticError("the tank is empty")
        return original(self, data, clock)

    with monkeypatch.context() as patch:
        patch.setattr(BasisPursuit, "recover", broken)
        assert sweep(small, tmp_path, *ONE).exit_code == 1
    assert sweep(small, tmp_path, *ONE, "--dry-run").stdout.startswith("0 of 7")
    dry = sweep(small, tmp_path, *ONE, "--rerun-failed", "--dry-run").stdout
    stages = ("recover", "filter", "assess")
    assert would_run(dry) == [f"small slow: {stage} triad" for stage in stages]
    assert "recover triad, runs 0-2: a run of it failed or diverged" in dry
    assert sweep(small, tmp_path, *ONE, "--rerun-failed").exit_code == 0
    assert sweep(small, tmp_path, *ONE, "--rerun-failed", "--dry-run").stdout.startswith("0 of 7")


def test_runs_that_diverged_are_filtered_again(
    small: Path, swept: Path, sweep: Callable, rewrite: Callable
) -> None:
    rewrite(small, LIMITED)
    asked = (*ONE, "--estimator", "wahba", "--rerun-failed", "--dry-run")
    dry = sweep(small, swept, *asked).stdout
    assert would_run(dry) == ["small slow: filter wahba", "small slow: assess wahba"]
