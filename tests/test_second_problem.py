"""A second problem, added by classes and lines of the catalog alone.

A target spins at a constant rate about z; a marker on its rim is seen in the plane. Its angle is
unwrapped, and a linear Kalman filter without process noise and with a wide start estimates angle
and rate, which is the straight line of least squares through the angles.
"""

from collections.abc import Callable
from io import StringIO
from pathlib import Path
from typing import Literal

import numpy as np
import pandas as pd
import pytest
from scipy.stats import chi2

from debrisest.catalog import CATALOG
from debrisest.draws import Stream
from debrisest.filters.estimates import Estimates, EstimatesWriter
from debrisest.filters.model import Model
from debrisest.results import store
from debrisest.roles import (
    FilterPart,
    Given,
    Positive,
    ProblemPart,
    RecoveryPart,
    SimulationPart,
    StartPart,
)


class Wheel(SimulationPart):
    truths = ("true_point_b",)
    kind: Literal["wheel"]
    radius_m: Positive

    def simulate(self, data, clock, draws):
        rim = np.array([[self.radius_m, 0.0, 0.0]])
        return {
            "feature": np.array(["rim"]),
            "true_point_b": np.broadcast_to(rim, (len(draws.runs), 1, 3)),
        }


class Spin(SimulationPart):
    truths = ("true_q_ib", "true_rate_b")
    kind: Literal["spin"]
    rate_deg_s: float

    def simulate(self, data, clock, draws):
        rate = np.radians(self.rate_deg_s)
        half = rate * clock.times / 2
        zero = np.zeros_like(half)
        q_ib = np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)
        shape = (len(draws.runs), len(half))
        return {
            "true_q_ib": np.broadcast_to(q_ib, (*shape, 4)),
            "true_rate_b": np.broadcast_to([0.0, 0.0, rate], (*shape, 3)),
        }


class Plane(SimulationPart):
    needs = ("true_point_b", "true_q_ib")
    measures = ("measured_point",)
    kind: Literal["plane"]
    noise_m: Positive

    def simulate(self, data, clock, draws):
        q, radius = data["true_q_ib"], data["true_point_b"][:, None, 0, 0]
        angle = 2 * np.arctan2(q[..., 3], q[..., 0])
        seen = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=-1)
        noise = draws.normal(Stream.MEASUREMENT_NOISE, seen.shape[1:])
        return {"measured_point": (seen + self.noise_m * noise)[:, :, None]}


class Unwrap(RecoveryPart):
    needs = ("measured_point",)
    gives = ("q_if",)
    kind: Literal["unwrap"]

    def recover(self, data, clock):
        x, y, _ = np.moveaxis(data["measured_point"][:, :, 0], -1, 0)
        half = np.unwrap(np.arctan2(y, x), axis=-1) / 2
        return {"q_if": np.stack([np.cos(half), 0 * half, 0 * half, np.sin(half)], axis=-1)}

    def assess(self, data):
        return {"coverage": np.isfinite(data["q_if"][..., 0]).mean(axis=-1)}


class Wide(StartPart):
    guesses = ("rate_b",)
    kind: Literal["wide"]
    variance: Positive

    def start(self, data, clock):
        runs = len(data["q_if"])
        return {"rate_b": np.zeros((runs, 2))}, {"rate_b": np.full((runs, 2), self.variance)}


class ConstantSpin(ProblemPart):
    needs = ("q_if",)
    model_kind = "model"
    start_needs = ("rate_b",)
    kind: Literal["constant_spin"]
    angle_noise_deg: Positive

    def measurements(self, data):
        q = data["q_if"]
        return np.unwrap(2 * np.arctan2(q[..., 3], q[..., 0]), axis=-1)[..., None]

    def model(self, data, clock):
        step = np.array([[1.0, clock.step], [0.0, 1.0]])
        return Model(
            process=lambda state, _: state @ step.T,
            measurement=lambda state, _: state[..., :1],
            process_noise=np.zeros((2, 2)),
            measurement_noise=np.radians(self.angle_noise_deg) ** 2 * np.eye(1),
            error_names=("angle", "rate_3"),
        )

    def pack(self, guess, variance):
        state = guess["rate_b"]
        return state, variance["rate_b"][..., None] * np.eye(2)

    def unpack(self, filtered):
        return {"rate_b": about_z(filtered.state), "rate_b_sigma": about_z(filtered.sigma)}

    def assess(self, data, scored):
        if "true_rate_b" not in data:
            return {}
        return {"rate_3": (data["rate_b"] - data["true_rate_b"])[..., 2]}


def about_z(values):
    return np.stack([0 * values[..., 1], 0 * values[..., 1], values[..., 1]], axis=-1)


class Kalman(FilterPart):
    takes = "model"
    kind: Literal["kalman"]

    def run(self, model: Model, given: Given) -> Estimates:
        state, covariance, measured = given.state, given.covariance, given.measured
        f, h = model.process(np.eye(2), 0).T, model.measurement(np.eye(2), 0).T
        writer = EstimatesWriter(model.error_names, state, covariance, measured.shape[1])
        for k in range(measured.shape[1]):
            if k:
                state = state @ f.T
                covariance = f @ covariance @ f.T + model.process_noise
            innovation = measured[:, k] - state @ h.T
            size = h @ covariance @ h.T + model.measurement_noise
            gain = covariance @ h.T / size
            state = state + (gain @ innovation[..., None])[..., 0]
            rest = np.eye(2) - gain @ h
            covariance = rest @ covariance @ np.swapaxes(rest, -1, -2) + (
                gain @ model.measurement_noise @ np.swapaxes(gain, -1, -2)
            )
            nis = innovation[:, 0] ** 2 / size[:, 0, 0]
            writer.record(k, state, covariance, {"nis": nis, "nis_dof": np.ones_like(nis)})
        return writer.estimates()


ADDED = {
    "target": Wheel,
    "motion": Spin,
    "sensors": Plane,
    "recovery": Unwrap,
    "start": Wide,
    "problem": ConstantSpin,
    "filter": Kalman,
}
RADIUS, NOISE, EPOCHS, RUNS = 2.0, 0.01, 50, 120
TEXT = f"""
title: A wheel that spins
seed: 3
runs: {RUNS}
duration_s: 25
step_s: 0.5
target: {{kind: wheel, radius_m: {RADIUS}}}
motion: {{kind: spin, rate_deg_s: 30}}
sensors: {{camera: {{kind: plane, noise_m: {NOISE}}}}}
estimators:
  line:
    recovery: {{kind: unwrap}}
    start: {{kind: wide, variance: 1e4}}
    problem: {{kind: constant_spin, angle_noise_deg: {np.degrees(NOISE / RADIUS)}}}
    filter: {{kind: kalman}}
tables:
  layout:
    - {{table: spin, title: Spin rate, stage: filter, quantities: [rate_3], statistics: [rms],
       windows: [end]}}
    - {{table: spin, title: Consistency, stage: filter, quantities: [nis], statistics: [mean],
       windows: [10-25 s]}}
"""


def bound(epochs: int, step: float) -> float:
    """Standard deviation of the slope of a straight line by least squares, rad/s."""
    return NOISE / RADIUS * np.sqrt(12 / (epochs * (epochs**2 - 1))) / step


@pytest.fixture
def config(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for role, part in ADDED.items():
        monkeypatch.setitem(CATALOG, role, [*CATALOG[role], part])
    path = tmp_path / "wheel.yaml"
    path.write_text(TEXT)
    return path


def test_from_a_file_to_a_table(config: Path, tmp_path: Path, sweep: Callable) -> None:
    result = sweep(config, tmp_path / "out")
    assert result.exit_code == 0, result.stderr
    rows = pd.read_csv(StringIO((tmp_path / "out" / "wheel" / "tables.csv").read_text()))
    rate, nis = (rows[rows["quantity"] == name].iloc[0] for name in ("rate_3", "nis"))
    assert (rate["case"], rate["estimator"], rate["unit"]) == ("nominal", "line", "deg/s")
    assert (rate["runs"], rate["failed"], rate["diverged"]) == (RUNS, 0, 0)
    # the square over the bound's is chi-squared with RUNS degrees: within 5 standard deviations
    expected = np.degrees(bound(EPOCHS, 0.5))
    assert abs((rate["measured"] / expected) ** 2 - 1) < 5 * np.sqrt(2 / RUNS)
    assert rate["ci_low"] < rate["measured"] < rate["ci_high"]
    assert abs(nis["measured"] - 1) < 5 * np.sqrt(2 / (RUNS * 30))


@pytest.mark.parametrize(("factor", "words"), [(0.8, "over-confident"), (1.25, "over-cautious")])
def test_a_mistuned_filter_is_told_in_words(
    factor: float, words: str, config: Path, tmp_path: Path, sweep: Callable, rewrite: Callable
) -> None:
    """A filter that takes its angles for too good or too bad; a problem need not judge itself."""
    noise = f"estimators.line.problem.angle_noise_deg={factor * np.degrees(NOISE / RADIUS)}"
    result = sweep(rewrite(config, noise), tmp_path / "out")
    rows = pd.read_csv(StringIO((tmp_path / "out" / "wheel" / "tables.csv").read_text()))
    nis = rows[rows["quantity"] == "nis"].iloc[0]
    assert nis["verdict"] == words
    assert nis["measured"] == pytest.approx(factor**-2, rel=5 * np.sqrt(2 / (RUNS * 30)))
    low, high = chi2.interval(0.95, RUNS * 30)
    assert nis["consistent_low"] == pytest.approx(low / (RUNS * 30), 1e-5)
    assert nis["consistent_high"] == pytest.approx(high / (RUNS * 30), 1e-5)
    assert any("line" in line and words in line for line in result.stdout.splitlines())


def test_the_filter_is_the_straight_line(config: Path, tmp_path: Path, sweep: Callable) -> None:
    assert sweep(config, tmp_path / "out", "--runs", 3).exit_code == 0
    folder = tmp_path / "out" / "wheel" / "nominal"
    seen = store.read(folder / "simulate.000000.h5")["measured_point"][:, :, 0]
    found = store.read(folder / "filter-line.000000.h5")
    angles = np.unwrap(np.arctan2(seen[..., 1], seen[..., 0]), axis=-1)
    slopes = np.polyfit(np.arange(EPOCHS) * 0.5, angles.T, 1)[0]
    assert found["rate_b"][:, -1, 2] == pytest.approx(slopes, abs=1e-7)
    assert found["rate_b_sigma"][:, -1, 2] == pytest.approx([bound(EPOCHS, 0.5)] * 3, rel=1e-5)
    assert found["error_name"].tolist() == ["angle", "rate_3"]


def test_two_problems_in_one_catalog(
    config: Path, small: Path, tmp_path: Path, cli: Callable
) -> None:
    result = cli("validate", config, small)
    assert result.exit_code == 0
    small.write_text(small.read_text().replace("kind: unscented", "kind: kalmann"))
    result = cli("validate", small)
    assert "'kalmann'; allowed: batch, unscented, " in result.stderr
    assert ", kalman (did you mean kalman?)" in result.stderr


def test_the_parts_of_different_problems_are_told_apart(
    config: Path, tmp_path: Path, cli: Callable
) -> None:
    config.write_text(TEXT.replace("    recovery: {kind: unwrap}\n", ""))
    result = cli("validate", config)
    assert result.exit_code == 2
    assert "constant_spin needs q_if" in result.stderr
    assert "recovery unwrap" in result.stderr
