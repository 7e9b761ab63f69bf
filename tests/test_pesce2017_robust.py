"""The disturbed stereo pose: the same experiment as the undisturbed one, and short runs of it."""

from collections.abc import Callable
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from debrisest.scenario.document import parse
from debrisest.scenario.load import load_scenario

CASES = ["outliers-B", "occluded-C"]
ERRORS = ["position", "velocity", "rate", "attitude", "k1", "k2"]


@pytest.mark.parametrize("case", ["A-deg", "B", "C"])
def test_the_undisturbed_cases_are_those_of_the_paper(shipped: Path, case: str) -> None:
    paper, robust = (
        load_scenario(shipped / f"{name}.yaml").cases[case].scenario
        for name in ("pesce2017", "pesce2017-robust")
    )
    assert robust.simulation == paper.simulation
    assert robust.seed == paper.seed and np.array_equal(robust.clock.times, paper.clock.times)
    assert robust.tables.diverged == paper.tables.diverged
    for name, same in (("ungated", "best"), ("bound", "bound")):
        ours, theirs = robust.estimators[name], paper.estimators[same]
        assert ours.model_dump(exclude={"cases"}) == theirs.model_dump(exclude={"cases"})


def test_poor_guesses_have_ten_times_the_variance(shipped: Path) -> None:
    cases = load_scenario(shipped / "pesce2017-robust.yaml").cases
    for case in ("A-deg", "B", "C"):
        clean, poor = (
            cases[name].scenario.starts["guess"].model_dump() for name in (case, f"P0x10-{case}")
        )
        for key in clean.keys() - {"kind"}:
            assert poor[key] ** 2 == pytest.approx(10 * clean[key] ** 2, rel=1e-6)


@pytest.fixture(scope="module")
def rows(shipped: Path, tmp_path_factory: pytest.TempPathFactory, sweep: Callable) -> pd.DataFrame:
    """Tables of 2 runs over 6 s."""
    folder = tmp_path_factory.mktemp("robust")
    scenario = parse((shipped / "pesce2017-robust.yaml").read_text(), "shipped")[0].value
    for estimator in scenario["estimators"].values():
        estimator.pop("cases", None)
        estimator["filter"]["keep_s"] = []
    table = {"table": "1", "title": "Errors", "stage": "filter", "quantities": ERRORS}
    changes = {
        "runs": 2,
        "duration_s": 6,
        "cases": {name: scenario["cases"][name] for name in CASES},
        "tables": {
            "diverged": [{"quantity": "rate", "above": 0.5, "window": "5 s"}],
            "layout": [table | {"statistics": ["p50"], "windows": ["3-6 s"]}],
        },
    }
    config = folder / "robust.yaml"
    config.write_text(yaml.safe_dump(scenario | changes, sort_keys=False))
    result = sweep(config, folder)
    assert result.exit_code == 0, result.output
    return pd.read_csv(StringIO((folder / "robust" / "tables.csv").read_text()))


def test_what_a_disturbed_run_loses_is_counted(rows: pd.DataFrame) -> None:
    assert len(rows) == len(CASES) * 3 * len(ERRORS)
    assert (rows["failed"] == 0).all()
    assert (rows["measured"].notna() | (rows["diverged"] == 2)).all()


def test_the_gate_keeps_outliers_out(rows: pd.DataFrame) -> None:
    struck = rows[rows["case"] == "outliers-B"].set_index(["quantity", "estimator"])
    lost = struck["diverged"].loc["velocity"]
    assert lost["best"] == lost["bound"] == 0
    velocity = struck["measured"].loc["velocity"]
    assert lost["ungated"] == 2 or velocity["best"] < velocity["ungated"]
