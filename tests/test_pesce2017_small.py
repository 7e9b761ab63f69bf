"""The stereo pose scenario with few runs and seconds, all estimators, through the command line."""

from collections.abc import Callable
from io import StringIO
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import yaml

from debrisest.results import store
from debrisest.scenario.document import parse

RUNS, EPOCHS = 3, 12
ESTIMATORS = ["printed", "reproduction", "extended", "best", "smoother", "pixels_only"]
ESTIMATORS += ["bound", "smoother_bound"]
QUANTITIES = ["position", "velocity", "rate", "attitude", "k1", "k2"]


def shortened(text: str) -> dict:
    """The shipped scenario over 12 s, with the cases A-deg and C-late and one table."""
    scenario = parse(text, "shipped")[0].value
    late = scenario["cases"]["C-late"] | {"duration_s": EPOCHS + 1}
    for estimator in scenario["estimators"].values():
        estimator["filter"]["keep_s"] = [1, 10]
    table = {"table": "4", "title": "Errors", "stage": "filter"}
    return scenario | {
        "runs": RUNS,
        "keep": "all",
        "duration_s": EPOCHS,
        "cases": {"A-deg": scenario["cases"]["A-deg"], "C-late": late},
        "tables": {
            "diverged": [{"quantity": "position", "above": 5, "window": "10 s"}],
            "layout": [
                table | {"quantities": QUANTITIES, "statistics": ["p50"], "windows": ["6-12 s"]},
                table
                | {"quantities": ["nees"], "statistics": ["median"], "windows": ["1 s", "10 s"]},
            ],
        },
    }


@pytest.fixture(scope="module")
def scenario(shipped: Path) -> dict:
    return shortened((shipped / "pesce2017.yaml").read_text())


@pytest.fixture(scope="module")
def swept(scenario: dict, tmp_path_factory: pytest.TempPathFactory, sweep: Callable) -> Path:
    folder = tmp_path_factory.mktemp("stereo")
    config = folder / "stereo.yaml"
    config.write_text(yaml.safe_dump(scenario, sort_keys=False))
    result = sweep(config, folder)
    assert result.exit_code == 0, result.output
    return folder / "stereo"


@pytest.fixture(scope="module")
def rows(swept: Path) -> pd.DataFrame:
    return pd.read_csv(StringIO((swept / "tables.csv").read_text()))


def test_every_cell_is_there(rows: pd.DataFrame) -> None:
    errors = rows[rows["statistic"] == "p50"]
    assert len(errors) == 2 * len(ESTIMATORS) * len(QUANTITIES)
    assert errors["failed"].max() == 0
    sure = errors[errors["estimator"].isin(["best", "smoother", "bound", "smoother_bound"])]
    assert sure["diverged"].max() == 0
    assert np.isfinite(sure["measured"]).all()


def test_each_bound_is_that_of_its_kind(rows: pd.DataFrame) -> None:
    by_cell = rows.set_index(["case", "quantity", "window", "estimator"])["measured"]
    for row in rows.to_dict("records"):
        name = "smoother_bound" if row["estimator"].startswith("smoother") else "bound"
        assert row["bound"] == by_cell[row["case"], row["quantity"], row["window"], name]


def test_the_bound_is_consistent_with_its_covariance(rows: pd.DataFrame) -> None:
    """The median of three chi-squares of 29 degrees, wide of five standard deviations."""
    nees = rows[(rows["quantity"] == "nees") & (rows["case"] == "A-deg")]
    for estimator in ("bound", "smoother_bound", "best"):
        measured = nees[nees["estimator"] == estimator]["measured"]
        assert measured.between(0.3, 2.5).all()


def test_a_late_score_sees_the_turn_of_a_second(rows: pd.DataFrame) -> None:
    """The target turns by 1.7 deg in a second, which dwarfs the bound's attitude error."""
    late = rows[(rows["case"] == "C-late") & (rows["quantity"] == "attitude")]
    assert late.set_index("estimator").loc["bound", "measured"] == pytest.approx(1.7, abs=0.9)
    assert late.set_index("estimator").loc["bound", "measured"] > 1.0


def test_estimates_lie_within_their_sigmas(swept: Path) -> None:
    true = store.read(swept / "A-deg" / "simulate.000000.h5")
    for estimator in ("best", "smoother", "bound"):
        found = store.read(swept / "A-deg" / f"filter-{estimator}.000000.h5")
        for name in ("position", "velocity", "rate_l", "q_lt"):
            gap = found[name] - true[f"true_{name}"]
            normal = (gap / found[f"{name}_sigma"])[:, 3:]
            assert np.abs(normal).max() < 6
            assert 0.1 < np.sqrt(np.mean(normal**2)) < 2.5
        assert found["covariance_time_s"].tolist() == [1.0, 10.0, 11.0]
        assert found["point_b"].shape == (RUNS, EPOCHS, 5, 3)


def test_what_the_filters_count_is_stored(swept: Path) -> None:
    printed = store.read(swept / "A-deg" / "filter-printed.000000.h5")
    assert printed["updates"].shape == (RUNS, EPOCHS)
    assert np.all(printed["repairs"] == 0)
    best = store.read(swept / "A-deg" / "assess-best.000000.h5")
    assert np.all(best["converged"] == 1)
    assert best["position"].shape == (RUNS, EPOCHS)
    assert best["position_error"].shape == (RUNS, EPOCHS, 3)


def test_the_excess_cost_of_the_truth_is_that_of_a_consistent_estimator(swept: Path) -> None:
    """Three chi-squares of 29 degrees: within five standard deviations, 0.15 each."""
    for estimator, epochs in (("best", [1, 10, 11]), ("smoother", [11]), ("pixels_only", [11])):
        found = store.read(swept / "A-deg" / f"assess-{estimator}.000000.h5")
        assert np.all(np.abs(found["w"][:, epochs].mean(axis=0) - 1) < 0.76)
        assert np.all(found["w_dof"][:, epochs] == 29)
        assert np.all(np.isnan(found["w"]) == (found["w_dof"] == 0))
    assert "w" not in store.read(swept / "A-deg" / "assess-bound.000000.h5")


def test_the_frame_of_a_position_is_told(swept: Path) -> None:
    with h5py.File(swept / "A-deg" / "simulate.000000.h5", "r") as file:
        assert "leader" in file["true_position"].attrs["frame"]
        assert file["true_position"].attrs["units"] == "m"


def test_a_filter_that_needs_another_model_is_told(
    scenario: dict, tmp_path: Path, cli: Callable
) -> None:
    config = tmp_path / "mixed.yaml"
    estimators = dict(scenario["estimators"])
    estimators["best"] = estimators["best"] | {"problem": estimators["printed"]["problem"]}
    config.write_text(yaml.safe_dump(scenario | {"estimators": estimators}, sort_keys=False))
    result = cli("validate", config)
    assert result.exit_code == 2
    assert "replay takes a replay model" in result.stderr
    assert "problems that fit replay: tumbling_points, stereo_pose" in result.stderr
