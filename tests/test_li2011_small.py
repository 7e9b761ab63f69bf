"""The scenario of two observers with few runs and seconds, through the command line."""

import re
from collections.abc import Callable
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from debrisest.errors import UserError
from debrisest.results import store
from debrisest.scenario.document import parse
from debrisest.scenario.load import load_scenario

RUNS, EPOCHS = 2, 72
USED = {
    "nominal": ["printed", "printed_b", "reproduction", "best", "nearest_neighbour", "bound"],
    "persistent": ["reproduction", "nearest_neighbour", "joint", "joint_updates"],
    "bias": ["reproduction", "bias"],
    "printed-axes": ["reproduction"],
}


def shortened(text: str) -> dict:
    """The shipped scenario over the first turn and six seconds more."""
    scenario = parse(text, "shipped")[0].value
    for estimator in scenario["estimators"].values():
        estimator["cases"] = [case for case in USED if case in estimator["cases"]]
        estimator["filter"]["keep_s"] = [24, 71]
    table = {"stage": "filter", "windows": ["24 s", "71 s"], "statistics": ["rms"]}
    position = {"table": "position", "title": "Position", "quantities": ["position"]}
    layout = [
        table | position | {"units": {"position": "km"}},
        table | {"table": "metres", "title": "Position", "quantities": ["position", "velocity"]},
        table
        | {"table": "lost", "title": "Lost", "quantities": ["lost", "far"]}
        | {"statistics": ["ever"], "windows": ["60-72 s"], "count_diverged": True},
        {"table": "sections", "title": "First section", "stage": "simulate"}
        | {"quantities": ["first_section"], "statistics": ["value"], "windows": ["end"]},
    ]
    return scenario | {
        "runs": RUNS,
        "duration_s": EPOCHS,
        "cases": {name: scenario["cases"][name] | {"runs": RUNS} for name in USED},
        "tables": {
            "published": "li2011.csv",
            "diverged": [
                {"quantity": "lost", "above": 0.5, "window": "60-72 s", "statistic": "ever"}
            ],
            "layout": layout,
        },
    }


@pytest.fixture(scope="module")
def config(shipped: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("observers")
    scenario = shortened((shipped / "li2011.yaml").read_text())
    (folder / "small.yaml").write_text(yaml.safe_dump(scenario, sort_keys=False))
    published = (shipped / "published" / "li2011.csv").read_text().splitlines(keepends=True)
    of_tables = [line for line in published if not line.startswith("consistency")]
    (folder / "li2011.csv").write_text("".join(of_tables))
    return folder / "small.yaml"


@pytest.fixture(scope="module")
def swept(config: Path, sweep: Callable) -> Path:
    result = sweep(config, config.parent, "--check")
    assert result.exit_code == 0, result.output
    return config.parent / "small"


@pytest.fixture(scope="module")
def rows(swept: Path) -> pd.DataFrame:
    return pd.read_csv(StringIO((swept / "tables.csv").read_text()), keep_default_na=True)


def test_estimators_run_in_their_cases_only(swept: Path, rows: pd.DataFrame) -> None:
    for case, used in USED.items():
        files = {path.name.split(".")[0] for path in (swept / case).glob("*.h5")}
        wanted = {f"{stage}-{name}" for name in used for stage in ("filter", "assess")}
        assert files == {"simulate"} | wanted
        shown = rows[(rows["table"] == "position") & (rows["case"] == case)]
        assert list(dict.fromkeys(shown["estimator"])) == used


def test_a_table_has_the_unit_that_it_asks_for(swept: Path, rows: pd.DataFrame) -> None:
    data = store.read(swept / "nominal" / "assess-best.000000.h5")
    expected = np.sqrt(np.mean(data["position"][:, 24] ** 2))
    cell = (rows["case"] == "nominal") & (rows["estimator"] == "best") & (rows["window"] == "24 s")
    cell &= rows["quantity"] == "position"
    found = rows[cell].set_index("table")
    assert found.loc["position", "unit"] == "km" and found.loc["metres", "unit"] == "m"
    assert found.loc["position", "measured"] == pytest.approx(1e-3 * expected, rel=1e-5)
    assert found.loc["metres", "measured"] == pytest.approx(expected, rel=1e-5)
    assert found.loc["position", "bound"] < 1e-2 * found.loc["metres", "bound"]


def test_lost_tracks_count_where_a_table_says_so(rows: pd.DataFrame) -> None:
    behind = rows[(rows["case"] == "printed-axes") & (rows["estimator"] == "reproduction")]
    by_table = behind.set_index(["table", "quantity"])
    assert by_table.loc[("lost", "lost"), "measured"] == 1.0
    assert by_table.loc[("lost", "lost"), "diverged"] == 0
    assert (by_table.loc["position"]["diverged"] == RUNS).all()
    assert by_table.loc["position"]["measured"].isna().all()
    seen = rows[(rows["case"] == "nominal") & (rows["table"] == "lost")]
    assert (seen[seen["quantity"] == "lost"]["measured"] == 0.0).all()


def test_the_first_section_is_reproduced_but_with_the_printed_axes(rows: pd.DataFrame) -> None:
    shown = rows[rows["table"] == "sections"].set_index("case")
    assert shown.loc["nominal", ["measured", "verdict"]].tolist() == [25.0, "reproduced"]
    assert shown.loc["printed-axes", "verdict"] == "not reproduced"


def test_everything_that_was_simulated_is_stored(swept: Path) -> None:
    data = store.read(swept / "persistent" / "simulate.000000.h5")
    assert data["observer"].tolist() == ["s1", "s2"]
    assert data["observer_position"].shape == (RUNS, EPOCHS, 2, 3)
    assert data["measured_pixel"].shape == (RUNS, EPOCHS, 2, 3, 2)
    assert data["start_companion_position"].shape == (RUNS, 2, 3)
    assert set(np.unique(data["section"])) == {0.0, 1.0, 2.0}
    assert data["torque"].shape[2:] == (2, 3)
    shown = np.isfinite(data["measured_pixel"][:, 0, :, 0, 0])
    assert shown.all()


def test_biases_are_estimated_and_named(swept: Path) -> None:
    data = store.read(swept / "bias" / "filter-bias.000000.h5")
    assert data["attitude_bias"].shape == (RUNS, EPOCHS, 2, 3)
    assert data["error_name"].tolist()[6:9] == ["bias_1_x", "bias_1_y", "bias_1_z"]
    assert data["covariance"].shape == (RUNS, 2, 12, 12)


def test_what_was_simulated_is_drawn_once_for_each_case(
    config: Path, swept: Path, cli: Callable
) -> None:
    options = ("--out", config.parent, "--case", "nominal", "--estimator", "best")
    result = cli("plot", config, *options)
    assert result.exit_code == 0, result.output
    drawn = {path.stem for path in (swept / "plots").glob("*.png")}
    assert {"torques-nominal", "pixel_paths-nominal"} <= drawn
    assert {"orbit_error-nominal-best", "covariance_trace-nominal-best"} <= drawn


@pytest.mark.parametrize(
    ("override", "said"),
    [
        ("sensors.camera.half_size_px=[20, 20]", "every camera|any camera|no camera|outside"),
        ("sensors.control.inertia_kg_m2=[[0,0,0],[0,0,0],[0,0,0]]", "positive principal moments"),
        ("estimators.best.filter.detection_probability=0", "must be greater than 0"),
        ("estimators.best.filter.detection_probability=1.5", "less than or equal to 1"),
        ("estimators.best.filter.gate=-1", "must be greater than 0"),
        ("sensors.control.control_step_s=1e-9", "must be at most step_s, 1 s, and at least"),
        ("sensors.control.control_step_s=1e300", "must be at most step_s, 1 s, and at least"),
        ("sensors.control.margin_px=300", "must be less than the camera's half_size_px, 180 px"),
        ("sensors.control.switching.least_s=90", "must not be longer than most_s, 40 s"),
        ("sensors.points.clutter={count: 1000000000000000, half_width_px: 1}", "not enough memory"),
        ("sensors.points.companions={count: 8, spread_km: 1}", "at most 7 pieces beside"),
        ("estimators.best.cases=[nominl]", "unknown case 'nominl'.*did you mean nominal"),
        (
            "tables.layout=[{table: a, title: b, stage: filter, quantities: [position], "
            "statistics: [rms], windows: [24 s], units: {position: px}}]",
            "cannot be shown in 'px'",
        ),
    ],
)
def test_wrong_input_is_told_with_its_key(config: Path, override: str, said: str) -> None:
    with pytest.raises(UserError) as caught:
        load_scenario(config, [override])
    lines = str(caught.value).splitlines()
    key = override.partition("=")[0].split(".")
    assert any(re.search(said, line) for line in lines), lines
    assert len(lines) <= len(USED)
    assert all(key[1] in line for line in lines)
