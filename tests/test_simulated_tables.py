"""Tables of what was simulated, of a debris without extent or rotation, by added parts alone."""

from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
import pytest

from debrisest.catalog import CATALOG
from debrisest.draws import Stream
from debrisest.quantity import Quantity
from debrisest.roles import Positive, RecoveryPart, SimulationPart
from debrisest.vocabulary import VOCABULARY

EPOCHS, RUNS = 10, 30


class Beacon(SimulationPart):
    """A lamp whose brightness grows with time, from a level that is drawn."""

    truths = ("beacon", "beacon_drift", "beacon_axes")
    measures = ("measured_point",)
    kind: Literal["beacon"]
    drift_deg_s: Positive
    fails: bool = False

    def simulate(self, data, clock, draws):
        level = draws.normal(Stream.TRUTH, ())
        if self.fails and 1 in draws.runs:
            raise ValueError("the lamp is broken")
        runs = len(level)
        return {
            "beacon": level[:, None] + clock.times,
            "beacon_drift": np.full(runs, np.radians(self.drift_deg_s)),
            "beacon_axes": np.zeros((runs, len(clock.times), 3)),
            "measured_point": np.zeros((runs, len(clock.times), 1, 3)),
        }


class Watch(RecoveryPart):
    needs = ("measured_point",)
    gives = ("q_if",)
    kind: Literal["watch"]

    def recover(self, data, clock):
        return {"q_if": np.ones((*data["measured_point"].shape[:2], 4))}

    def assess(self, data):
        return {"coverage": np.ones(len(data["q_if"]))}


ADDED = {
    "beacon": Quantity(("run", "time_s"), "m", "brightness of a lamp", "km"),
    "beacon_drift": Quantity(("run",), "rad/s", "its drift", "deg/s"),
    "beacon_axes": Quantity(("run", "time_s", "axis"), "m", "a vector", "m"),
}
TEXT = f"""
title: A lamp
seed: 4
runs: {RUNS}
duration_s: {EPOCHS}
step_s: 1
sensors: {{lamp: {{kind: beacon, drift_deg_s: 3}}}}
estimators:
  one: {{recovery: {{kind: watch}}}}
  bound: {{recovery: {{kind: watch}}}}
tables:
  published: lamp.csv
  means: {{both: [dim, bright]}}
  layout:
    - {{table: "1", title: The lamp, stage: simulate, quantities: [beacon, beacon_drift],
       statistics: [mean], windows: [4-6 s]}}
    - {{table: "2", title: The drift, stage: simulate, quantities: [beacon_drift],
       statistics: [p100], windows: [end], cases: [dim]}}
    - {{table: "3", title: The watch, stage: recover, quantities: [coverage],
       statistics: [mean], windows: [end]}}
cases:
  dim: {{}}
  bright: {{sensors: {{lamp: {{drift_deg_s: 5}}}}}}
"""
PUBLISHED = """table,case,quantity,statistic,window,published,factor,-,one
1,dim,beacon_drift,mean,4-6 s,3.1,1.2,reproduced,
1,bright,beacon_drift,mean,4-6 s,3.1,1.2,worse,
"""


@pytest.fixture
def config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for role, part in (("sensors", Beacon), ("recovery", Watch)):
        monkeypatch.setitem(CATALOG, role, [*CATALOG[role], part])
    for name, quantity in ADDED.items():
        monkeypatch.setitem(VOCABULARY, name, quantity)
    (tmp_path / "lamp.csv").write_text(PUBLISHED)
    path = tmp_path / "lamp.yaml"
    path.write_text(TEXT)
    return path


def rows_in(folder: Path) -> pd.DataFrame:
    return pd.read_csv(StringIO((folder / "lamp" / "tables.csv").read_text()))


def test_cells_of_what_was_simulated(config: Path, tmp_path: Path, sweep: Callable) -> None:
    result = sweep(config, tmp_path / "out", "--check")
    assert result.exit_code == 0, result.stderr
    rows = rows_in(tmp_path / "out")
    first = rows[rows["table"] == 1]
    assert set(first["estimator"]) == {"-"}
    assert first["case"].tolist() == ["dim", "dim", "bright", "bright", "both", "both"]
    drift = first[first["quantity"] == "beacon_drift"].set_index("case")
    assert drift["measured"].to_dict() == pytest.approx({"dim": 3, "bright": 5, "both": 4})
    assert drift["verdict"].to_dict() == {
        "dim": "reproduced", "bright": "worse", "both": "unpublished",
    }  # fmt: skip
    assert drift["runs"].to_dict() == {"dim": RUNS, "bright": RUNS, "both": 2 * RUNS}
    level = first[(first["quantity"] == "beacon") & (first["case"] == "dim")].iloc[0]
    assert level["unit"] == "km"
    assert abs(1e3 * level["measured"] - 4.5) < 5 / np.sqrt(RUNS)
    assert first["bound"].isna().all()
    assert set(rows[rows["table"] == 3]["estimator"]) == {"one", "bound"}


def test_they_are_shown_beside_the_paper(config: Path, tmp_path: Path, sweep: Callable) -> None:
    text = sweep(config, tmp_path / "out").stdout
    assert "Table 1: The lamp: mean, 4-6 s" in text
    lines = text.splitlines()
    assert any("paper" in line and "3.1" in line for line in lines)
    assert any("simulated" in line and "3 [3, 3] =" in line for line in lines)
    assert "Table 2: The drift: beacon_drift (deg/s), p100, end" in text
    chosen = sweep(config, tmp_path / "out", "--estimator", "one", "--case", "bright").stdout
    assert "The lamp" in chosen
    assert "dim" not in chosen


def test_a_failed_simulation_is_counted(
    config: Path, tmp_path: Path, sweep: Callable, rewrite: Callable
) -> None:
    result = sweep(rewrite(config, "sensors.lamp.fails=true"), tmp_path / "out")
    assert result.exit_code == 1
    drift = rows_in(tmp_path / "out").query("table == 1 and quantity == 'beacon_drift'")
    assert drift.set_index("case")["failed"].to_dict() == {"dim": 1, "bright": 1, "both": 2}
    assert drift["measured"].tolist() == pytest.approx([3, 5, 4])


def test_a_simulation_that_is_out_of_date_is_left_out(
    config: Path, tmp_path: Path, cli: Callable, rewrite: Callable
) -> None:
    out = tmp_path / "out"
    assert cli("simulate", config, "--out", out, "--jobs", 1, "--runs", 3).exit_code == 0
    shown = cli("table", config, "--out", out, "--runs", 3)
    assert "left out of the tables: lamp dim: assess one" in shown.stderr
    assert set(rows_in(out)["table"]) == {1, 2}
    rewrite(config, "seed=8")
    stale = cli("table", config, "--out", out, "--runs", 3)
    assert "left out of the tables: lamp dim: simulate" in stale.stderr
    assert stale.stdout == ""


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        ("rate", ["no part of the simulation gives 'rate'", "allowed: ", "beacon, beacon_axes"]),
        ("beacon_axes", ["beacon_axes has components"]),
        ("measured_point", ["no table can show 'measured_point'"]),
    ],
)
def test_what_no_simulation_gives_is_told(
    quantity: str, words: list[str], config: Path, cli: Callable
) -> None:
    config.write_text(TEXT.replace("[beacon_drift]", f"[{quantity}]"))
    result = cli("validate", config)
    assert result.exit_code == 2
    line = TEXT[: TEXT.index('table: "2"')].count("\n") + 1
    assert f"{config}:{line}" in result.stderr
    for word in words:
        assert word in result.stderr


@pytest.mark.parametrize(
    ("role", "words"),
    [
        ("target", ["needs true_point_b", "target rigid_points"]),
        ("motion", ["needs true_q_ib", "motion torque_free"]),
    ],
)
def test_without_a_part_its_data_are_missed(
    role: str, words: list[str], small: Path, cli: Callable
) -> None:
    """Neither a target nor a motion is asked for as such: a part that needs one says so."""
    lines = small.read_text().split("\n")
    start = lines.index(f"{role}:")
    end = next(i for i in range(start + 1, len(lines)) if lines[i] and lines[i][0] not in " #")
    text = "\n".join(lines[:start] + lines[end:])
    small.write_text(text.replace("{motion: {rate_deg_s: [3.0, 2.0, -1.0]}}", "{}"))
    result = cli("validate", small)
    assert result.exit_code == 2
    for word in words:
        assert word in result.stderr
