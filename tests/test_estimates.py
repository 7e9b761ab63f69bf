"""Estimates of any results: what is printed and what is written is what the files hold."""

import io
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from debrisest.results import store
from debrisest.scenario.document import parse
from debrisest.show.estimates import COLUMNS, _said

# scenario: a case, an estimator, a short duration, and a quantity with its unit and scale
EVERY_PROBLEM = {
    "first_steps": ("", "wahba", 30, "rate_b", "deg/s", 180 / np.pi),
    "pesce2017": ("A-deg", "best", 12, "position", "m", 1.0),
    "li2011": ("nominal", "reproduction", 72, "debris_position", "m", 1.0),
    "volpe2017": ("nominal", "online", 60, "rate_b", "deg/s", 180 / np.pi),
}


def shortened(config: Path, case: str, estimator: str, duration: float) -> str:
    """A shipped scenario with one case, one estimator and no tables."""
    text = parse(config.read_text(), "shipped")[0].value
    chosen = {k: v for k, v in text["estimators"][estimator].items() if k not in ("cases", "bound")}
    chosen["filter"] = {k: v for k, v in chosen["filter"].items() if k != "keep_s"}
    changed = {k: v for k, v in text.get("cases", {}).get(case, {}).items() if k != "estimators"}
    for key in ("cases", "grid", "tables"):
        text.pop(key, None)
    short = {"duration_s": duration, "estimators": {estimator: chosen}}
    return yaml.safe_dump(text | {"cases": {"short": changed}} | short, sort_keys=False)


def exported(folder: Path) -> pd.DataFrame:
    found = pd.read_csv(folder / "estimates.csv", dtype={"component": str, "unit": str})
    assert tuple(found.columns) == COLUMNS
    return found


def test_all_epochs_of_all_runs_are_written(swept: Path, small: Path, cli: Callable) -> None:
    done = cli("estimates", small, "--out", swept)
    assert done.exit_code == 0, done.stderr
    rows = exported(swept / "small")
    assert f"estimates.csv: {len(rows)} rows" in done.stderr
    data = store.read(swept / "small" / "fast" / "filter-wahba.000000.h5")
    assert len(rows) == 4 * 3 * 60 * (4 + 4 + 3 + 3)
    own = rows[(rows["case"] == "fast") & (rows["estimator"] == "wahba")]
    of_axis = own[(own["quantity"] == "rate_b") & (own["component"] == "2") & (own["run"] == 1)]
    assert set(of_axis["unit"]) == {"deg/s"}
    for column, name in (("value", "rate_b"), ("sigma", "rate_b_sigma")):
        np.testing.assert_allclose(of_axis[column], np.degrees(data[name][1, :, 1]), rtol=1e-14)
    np.testing.assert_array_equal(of_axis["time_s"], data["time_s"])
    quaternion = own[(own["quantity"] == "q_ib") & (own["run"] == 2)]
    assert quaternion["component"].tolist()[:5] == ["0", "1", "2", "3", "0"]
    np.testing.assert_array_equal(quaternion["value"], data["q_ib"][2].ravel())


def test_only_what_is_estimated_is_shown(swept: Path, small: Path, cli: Callable) -> None:
    done = cli("estimates", small, "--out", swept, "--case", "slow", "--format", "csv")
    shown = pd.read_csv(io.StringIO(done.stdout), dtype={"component": str})
    assert set(shown["quantity"]) == {"q_ib", "q_bf", "rate_b", "moments_b"}
    assert set(shown["case"]) == {"slow"}
    assert set(shown["time_s"]) == {59.0}
    assert set(shown["run"]) == {0}
    assert set(shown["status"]) == {"consistent"}
    assert set(exported(swept / "small")["case"]) == {"slow"}


def test_another_run_and_epoch(swept: Path, small: Path, cli: Callable) -> None:
    """At the last epoch that is not after the time."""
    asked = ("--estimator", "triad", "--case", "slow", "--run", 2, "--at", 30.9)
    done = cli("estimates", small, "--out", swept, *asked, "--format", "json")
    shown = pd.DataFrame(json.loads(done.stdout))
    data = store.read(swept / "small" / "slow" / "filter-triad.000000.h5")
    rate = shown[shown["quantity"] == "rate_b"]
    np.testing.assert_allclose(rate["value"], np.degrees(data["rate_b"][2, 30]), rtol=1e-12)
    assert set(shown["time_s"]) == {30.0}
    printed = cli("estimates", small, "--out", swept, *asked).stdout
    assert "Estimates: small slow, triad, run 2, at 30 s\nconsistent\n" in printed


def test_an_epoch_on_the_way_has_a_word_of_its_own() -> None:
    data = {"status": np.array(["consistent", "lost: nothing fits"]), "doubt": np.array([0, 3])}
    assert _said(data, 0, 1) == "consistent"
    data["doubt_at"] = np.array([[np.nan, 2.0, 0.0], [np.nan, 3.0, 3.0]])
    said = [_said(data, 0, epoch) for epoch in range(3)]
    assert said[0] == said[2] == "consistent"
    assert said[1] == "ambiguous, by what is known at the end; there: consistent"
    assert _said(data, 1, 1) == "lost: nothing fits"


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        (("--run", 7), "no estimates of run 7 that are up to date; run: debrisest sweep"),
        (("--at", -1), "--at -1: the first epoch is at 0 s"),
        (("--estimator", "wabha"), "did you mean wahba"),
    ],
)
def test_what_is_not_there_is_told(
    asked: tuple[object, ...], words: str, swept: Path, small: Path, cli: Callable
) -> None:
    done = cli("estimates", small, "--out", swept, *asked)
    assert done.exit_code == 2
    assert words in done.stderr
    assert not (swept / "small" / "estimates.csv").exists()


def test_what_is_out_of_date_is_left_out(swept: Path, small: Path, cli: Callable) -> None:
    text = yaml.safe_load(small.read_text())
    wahba = text["estimators"]["wahba"]
    wahba["filter"] = wahba["filter"] | {"alpha": 0.9}
    small.write_text(yaml.safe_dump(text, sort_keys=False))
    done = cli("estimates", small, "--out", swept, "--format", "csv")
    assert "left out of the estimates: small slow: filter wahba" in done.stderr
    assert "(and 1 more)" in done.stderr
    assert set(pd.read_csv(io.StringIO(done.stdout))["estimator"]) == {"triad"}
    assert set(exported(swept / "small")["estimator"]) == {"triad"}


def test_fewer_runs_than_the_scenario_wants(small: Path, tmp_path: Path, cli: Callable) -> None:
    some = ("--case", "slow", "--estimator", "wahba")
    assert cli("sweep", small, "--out", tmp_path, "--jobs", 1, "--runs", 2, *some).exit_code == 0
    done = cli("estimates", small, "--out", tmp_path, *some)
    assert (done.exit_code, "left out" in done.stderr) == (0, False)
    assert set(exported(tmp_path / "small")["run"]) == {0, 1}


@pytest.mark.parametrize("name", EVERY_PROBLEM)
def test_every_problem(name: str, tmp_path: Path, shipped: Path, cli: Callable) -> None:
    """All components of every quantity with a sigma, in units for people."""
    case, estimator, duration, quantity, unit, scale = EVERY_PROBLEM[name]
    config = tmp_path / f"{name}.yaml"
    config.write_text(shortened(shipped / config.name, case, estimator, duration))
    swept = cli("filter", config, "--out", tmp_path, "--jobs", 1, "--runs", 1, "--quiet")
    assert swept.exit_code == 0, swept.stderr
    done = cli("estimates", config, "--out", tmp_path)
    assert done.exit_code == 0, done.stderr
    rows = exported(tmp_path / name)
    data = store.read(tmp_path / name / "short" / f"filter-{estimator}.000000.h5")
    estimated = [key for key in data if f"{key}_sigma" in data]
    assert set(rows["quantity"]) == set(estimated)
    assert len(rows) == sum(data[key].size for key in estimated)
    own = rows[rows["quantity"] == quantity]
    np.testing.assert_allclose(own["value"], scale * data[quantity].ravel(), rtol=1e-14)
    assert set(own["unit"]) == {unit}
    assert not set(rows["unit"]) & {"rad", "rad/s"}
