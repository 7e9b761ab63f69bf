"""Figures that are made file by file are those of all errors at once."""

import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from debrisest.results.assessed import assessed
from debrisest.results.figured import figured
from debrisest.results.open import open_results
from debrisest.runner import cut
from debrisest.scenario.load import load_scenario
from debrisest.show.tables.figures import figures_of


def test_figures_of_one_file_after_the_other_are_those_of_all_runs(
    small: Path, tmp_path: Path, sweep: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cut, "RUNS_PER_FILE", 2)
    monkeypatch.setattr(cut, "MOST_PER_FILE", 3)
    assert sweep(small, tmp_path, "--case", "slow", "--runs", 7).exit_code == 0
    results, tables = open_results(tmp_path / "small"), load_scenario(small).common.tables
    found, whole = figured(results, lambda case: figures_of(tables, case)), assessed(results)
    assert found.keys() == whole.keys()
    for of, figure in itertools.product(whole, figures_of(tables, "slow")):
        one, other = found[of], whole[of]
        assert one.runs == other.runs == 7
        assert one.has(figure.dataset) == other.has(figure.dataset)
        for kind in ("figures", "freedom"):
            mine, theirs = (getattr(each, kind)(*figure) for each in (one, other))
            np.testing.assert_allclose(mine, theirs, rtol=1e-13)
        assert one.seen(figure.dataset, figure.window) == other.seen(figure.dataset, figure.window)
        np.testing.assert_array_equal(
            one.diverged(tables.diverged), other.diverged(tables.diverged)
        )
