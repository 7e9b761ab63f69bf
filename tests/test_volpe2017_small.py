"""The scenario of pose and shape over two minutes, through the command line."""

from collections.abc import Callable
from io import StringIO
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from debrisest.results import store
from debrisest.scenario.document import parse

RUNS, DURATION = 2, 120
CASES = ["nominal", "occluded", "surface-range", "slow"]


def shortened(text: str) -> dict:
    """The shipped scenario over 120 s, with the published filter and a table of its errors."""
    scenario = parse(text, "shipped")[0].value
    scenario["estimators"]["reproduction"]["filter"]["keep_s"] = []
    table = {"table": "1", "title": "Errors", "stage": "filter", "statistics": ["median"]}
    return scenario | {
        "runs": RUNS,
        "duration_s": DURATION,
        "estimators": {"reproduction": scenario["estimators"]["reproduction"] | {"cases": CASES}},
        "cases": {name: _changes(scenario["cases"][name]) for name in CASES},
        "tables": {
            "layout": [
                table
                | {
                    "quantities": ["position", "points", "aligned_points", "constraint"],
                    "windows": ["start", "end"],
                },
                table | {"quantities": ["velocity_remaining"], "windows": ["end"]},
            ]
        },
    }


def _changes(case: dict) -> dict:
    return {key: value for key, value in case.items() if key != "estimators"}


@pytest.fixture(scope="module")
def swept(shipped: Path, tmp_path_factory: pytest.TempPathFactory, sweep: Callable) -> Path:
    folder = tmp_path_factory.mktemp("shape")
    config = folder / "shape.yaml"
    scenario = shortened((shipped / "volpe2017.yaml").read_text())
    config.write_text(yaml.safe_dump(scenario, sort_keys=False))
    result = sweep(config, folder)
    assert result.exit_code == 0, result.output
    return folder / "shape"


def _read(swept: Path, case: str, stage: str) -> dict:
    return store.read(next((swept / case).glob(f"{stage}*.h5")), RUNS)


def test_every_case_gives_figures(swept: Path) -> None:
    rows = pd.read_csv(StringIO((swept / "tables.csv").read_text()))
    assert set(rows["case"]) == set(CASES)
    nominal = rows[(rows["case"] == "nominal")].set_index(["quantity", "window"])["measured"]
    assert nominal["aligned_points", "end"] < nominal["aligned_points", "start"]
    assert (rows[rows["case"] == "nominal"]["measured"] > 0).all()


def test_at_time_zero_the_principal_axes_are_the_cameras(swept: Path) -> None:
    """The quaternion of the scenario file is that of the camera; the errors of the axes tell."""
    data = _read(swept, "nominal", "assess-reproduction")
    truth = _read(swept, "nominal", "simulate")
    assert np.allclose(data["reference_point_b"], truth["true_point_b"], atol=1e-5)


def test_cases_differ_as_they_are_told_to(swept: Path) -> None:
    nominal, occluded = (_read(swept, case, "simulate") for case in ("nominal", "occluded"))
    assert np.isfinite(nominal["measured_pixel"][:, :, 0]).all()
    hidden = np.isnan(occluded["measured_pixel"][:, :, 0][..., 0]).mean()
    assert 0.1 < hidden < 0.5
    surface = _read(swept, "surface-range", "simulate")
    distance = np.linalg.norm(surface["chaser_position_h"], axis=-1)
    assert (distance - surface["measured_range"] > 0.4).all()
    slow = _read(swept, "slow", "simulate")
    assert not np.allclose(slow["true_point_b"][0], slow["true_point_b"][1])
    assert np.degrees(np.linalg.norm(slow["true_rate_b"], axis=-1)).max() < 0.15
