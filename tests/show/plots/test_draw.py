"""Which figures are drawn of a scenario's results, from which runs, and what is left out."""

import subprocess
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from debrisest.arrays import Array, Data
from debrisest.errors import UserError
from debrisest.results import store
from debrisest.results.assessed import Result, assessed
from debrisest.results.open import find_results
from debrisest.results.results import Results
from debrisest.results.status import Wanted, up_to_date
from debrisest.runner.compute import _attributes
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.runner.step import Step
from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.show.plots.draw import draw_all
from debrisest.show.plots.gather import all_runs, single_runs
from debrisest.show.plots.kinds import FIGURES, Kind
from debrisest.vocabulary import VOCABULARY

SCENARIO = """
title: A spinning body
seed: 1
runs: 3
duration_s: 12
step_s: 1
target:
  kind: rigid_points
  inertia_kg_m2: [1, 2, 2.5]
  points:
    a: {position_m: [1, 0, 0], normal: [1, 0, 0]}
    b: {position_m: [0, 1, 0], normal: [0, 1, 0]}
    c: {position_m: [0, 0, 1], normal: [0, 0, 1]}
orbit: {kind: kepler, semi_major_axis_km: 7178, inclination_deg: 98.6}
motion: {kind: torque_free, rate_deg_s: [0, 0, 2]}
observers:
  chaser: {kind: hold, position_m: [0, 30, 0]}
sensors:
  points: {kind: feature_points, noise_m: 0.05}
estimators:
  only:
    recovery: {kind: basis_pursuit, attitude: triad, penalty: 0.5}
    start:
      kind: first_samples
      samples: 15
      variance: &variance {q_ib: 1e-2, q_bf: 0.1, rate_rad2_s2: 2e-2, moments: 0.02}
    problem:
      kind: tumbling_attitude
      integrator: rk4
      process_noise: *variance
      measurement_noise: 1e-4
    filter: {kind: unscented, alpha: 1, beta: 2, kappa: 0}
tables:
  diverged:
    - {quantity: rate, above: 1, window: 6-12 s}
  means: {mean: [x, y]}
cases: {x: {}, y: {}, z: {}}
"""
QUANTITIES = ("rate_1", "rate_2", "rate_3")
TIMES = np.arange(12.0)


@pytest.fixture
def scenario(tmp_path: Path) -> LoadedScenario:
    path = tmp_path / "spin.yaml"
    path.write_text(SCENARIO)
    return load_scenario(path)


def _dataset(name: str, runs: int, value: float) -> Array:
    lengths = {"run": runs, "time_s": len(TIMES), "quaternion": 4, "axis": 3, "piece_number": 1}
    return np.full([lengths[axis] for axis in VOCABULARY[name].axes], value)


def _made_up(stage: str, runs: int, first: int) -> Data:
    """The datasets of a stage; every value of a run is the run's number."""
    names = {
        "simulate": ["true_position"],
        "recover": ["raw_q_if", "q_if", "piece", "sign"],
        "filter": ["rate_b", "rate_b_sigma", "moments_b"],
        "assess": ["rate", *QUANTITIES],
    }[stage]
    data = {name: _dataset(name, runs, 0.0) for name in names}
    for name in names:
        data[name] += 1e-3 * np.arange(runs).reshape(-1, *[1] * (data[name].ndim - 1))
    numbers = np.arange(first, first + runs, dtype=float)
    return data | {"run": numbers, "time_s": TIMES, "failure": np.full(runs, "")}


def _store(
    scenario: LoadedScenario, out: Path, stages: list[str], failing: dict[str, int] | None = None
) -> None:
    """Write the files of some stages as if they had been computed."""
    for step in plan(scenario, out, Selection()):
        stage = step.address.stage
        if stage in stages:
            data = _made_up(stage, step.runs, step.address.first_run)
            data["failure"] = data["failure"].astype(object)
            data["failure"][: (failing or {}).get(stage, 0)] = "broken"
            data["failure"] = data["failure"].astype(str)
            store.write(step.path, data, _attributes(step))


def _draw(scenario: LoadedScenario, out: Path, **selected: list[str]) -> list[Path]:
    return list(draw_all(scenario, out, plan(scenario, out, Selection(**selected))))


def _there(scenario: LoadedScenario, out: Path, steps: list[Step] | None = None) -> Results:
    """The results that are up to date with a plan, by default of the whole scenario."""
    wanted: list[Wanted] = [*(steps or plan(scenario, out, Selection()))]
    return up_to_date(find_results(out / scenario.name), wanted)


def _names(paths: Iterable[Path]) -> set[str]:
    return {path.name for path in paths}


def test_everything_is_drawn_of_complete_results(scenario: LoadedScenario, tmp_path: Path) -> None:
    _store(scenario, tmp_path, ["simulate", "recover", "filter", "assess"])
    paths = _draw(scenario, tmp_path, cases=["x"])
    single = ["raw_quaternion", "recovered_quaternion", "rates"]
    assert _names(paths) == {
        f"{name}.{form}"
        for form in ("png", "svg")
        for name in [
            "error_over_time-only",
            *(f"{figure}-x-only" for figure in single),
        ]
    }
    assert all(path.parent == tmp_path / "spin" / "plots" and path.exists() for path in paths)


def test_only_what_is_there_is_drawn(
    scenario: LoadedScenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, kind in FIGURES.items():
        monkeypatch.setitem(FIGURES, name, kind._replace(draw=lambda *_: Figure()))
    _store(scenario, tmp_path, ["simulate", "recover"])
    paths = _draw(scenario, tmp_path, cases=["y", "z"])
    assert {name.removesuffix(".svg") for name in _names(paths) if name.endswith(".svg")} == {
        f"{figure}-{case}-only"
        for figure in ("raw_quaternion", "recovered_quaternion")
        for case in ("y", "z")
    }


def test_nothing_to_draw_is_told(scenario: LoadedScenario, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="run: debrisest sweep") as caught:
        _draw(scenario, tmp_path)
    assert len(caught.value.problems) == 1
    assert not (tmp_path / "spin").exists()


def test_results_that_are_out_of_date_are_left_out(
    scenario: LoadedScenario, tmp_path: Path
) -> None:
    _store(scenario, tmp_path, ["simulate", "recover", "filter", "assess"])
    changed = load_scenario(scenario.path, ["sensors.points.noise_m=0.1"])
    with pytest.raises(UserError):
        _draw(changed, tmp_path)


def test_the_first_run_that_did_not_fail(scenario: LoadedScenario, tmp_path: Path) -> None:
    failing = {"recover": 1, "filter": 2}
    _store(scenario, tmp_path, ["simulate", "recover", "filter"], failing)
    sources = list(single_runs(scenario, _there(scenario, tmp_path), {}))
    assert [source.names for source in sources] == [(case, "only") for case in "xyz"]
    assert sources[0].context == "spin, case x, estimator only, run 2"
    assert sources[0].data["rate_b"].shape == (12, 3)
    np.testing.assert_array_equal(sources[0].data["rate_b"], 2e-3)
    np.testing.assert_array_equal(sources[0].data["time_s"], TIMES)


def test_no_run_no_figure(scenario: LoadedScenario, tmp_path: Path) -> None:
    _store(scenario, tmp_path, ["simulate"], {"simulate": 3})
    _store(scenario, tmp_path, ["recover"], {"recover": 3})
    assert list(single_runs(scenario, _there(scenario, tmp_path), {})) == []


def test_runs_of_a_second_file(scenario: LoadedScenario, tmp_path: Path) -> None:
    many = load_scenario(scenario.path, ["runs=22"])
    _store(many, tmp_path, ["simulate", "recover"], {"recover": 20})
    steps = plan(many, tmp_path, Selection(cases=["x"]))
    first = [step for step in steps if step.address.first_run == 0]
    assert list(single_runs(many, _there(many, tmp_path, first), {})) == []
    for step in steps:
        if step.address.first_run == 20 and step.address.stage == "recover":
            store.write(step.path, _made_up("recover", step.runs, 20), _attributes(step))
    steps = plan(many, tmp_path, Selection(cases=["x"]))
    (source,) = single_runs(many, _there(many, tmp_path, steps), {})
    assert source.context.endswith("run 20")


def _result(rates: Array, times: Array = TIMES, failures: dict[int, str] | None = None) -> Result:
    """Runs (run, axis) of constant errors, in degrees per second."""
    error = np.repeat(np.radians(rates)[:, None], len(times), axis=1)
    errors = {name: error[..., index] for index, name in enumerate(QUANTITIES)}
    errors["rate"] = np.linalg.norm(error, axis=-1)
    return Result(errors, times, failures or {}, len(rates))


def test_diverged_failed_and_infinite_runs_are_left_out_and_counted(
    scenario: LoadedScenario,
) -> None:
    good, wild = [0.1, 0.2, 0.3], [0.1, 0.2, 3.0]
    result = _result(np.array([good, wild, good, [np.nan] * 3, good]), failures={2: "broken"})
    (source,) = all_runs(scenario, {("x", "only"): result}, QUANTITIES)
    assert source.names == ("only",)
    assert source.data["rate_3"].shape == (2, 12)
    np.testing.assert_allclose(source.data["rate_3"], np.radians(0.3))
    assert source.context == (
        "spin, estimator only, 1 case, 5 runs; left out: 2 diverged, 1 failed"
    )


def test_cases_of_the_means_are_pooled_if_there_are_any(scenario: LoadedScenario) -> None:
    x, y, z = (_result(np.full((2, 3), value)) for value in (0.1, 0.2, 0.3))
    results = {("x", "only"): x, ("y", "only"): y, ("z", "only"): z}
    (source,) = all_runs(scenario, results, QUANTITIES)
    np.testing.assert_allclose(np.degrees(source.data["rate_1"][:, 0]), [0.1, 0.1, 0.2, 0.2])
    (source,) = all_runs(scenario, {("z", "only"): z}, QUANTITIES)
    np.testing.assert_allclose(np.degrees(source.data["rate_1"][:, 0]), 0.3)


def test_cases_may_have_their_own_epochs(scenario: LoadedScenario) -> None:
    x = _result(np.full((1, 3), 0.1))
    y = _result(np.full((1, 3), 0.2), np.arange(0.0, 12.0, 2.0))
    (source,) = all_runs(scenario, {("x", "only"): x, ("y", "only"): y}, QUANTITIES)
    np.testing.assert_array_equal(source.data["time_s"], TIMES)
    expected = np.radians([np.full(12, 0.1), np.where(TIMES % 2 == 0, 0.2, np.nan)])
    np.testing.assert_allclose(source.data["rate_2"], expected)


def test_estimators_without_a_good_run_or_without_errors_have_no_figure(
    scenario: LoadedScenario,
) -> None:
    lost = _result(np.full((2, 3), 5.0))
    without = replace(lost, errors={"rate": lost.errors["rate"]})
    results = {("x", "lost"): lost, ("x", "without"): without}
    assert list(all_runs(scenario, results, QUANTITIES)) == []


def test_figures_of_each_case_take_what_there_is(
    scenario: LoadedScenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: dict[str, set[str]] = {}

    def draw(data: Data, context: str) -> Figure:
        drawn[context] = set(data)
        return Figure()

    kind = Kind(draw, ("rate_1",), of_all_runs=True, of_each_case=True, also=("rate_2", "nothing"))
    monkeypatch.setattr("debrisest.show.plots.draw.FIGURES", {"each": kind})
    _store(scenario, tmp_path, ["simulate", "recover", "filter", "assess"])
    paths = _draw(scenario, tmp_path)
    assert _names(paths) == {f"each-{case}-only.{f}" for case in "xyz" for f in ("png", "svg")}
    assert list(drawn) == [
        f"spin, estimator only, case {case}, 3 runs; left out: 0 diverged" for case in "xyz"
    ]
    assert all(names == {"time_s", "rate_1", "rate_2"} for names in drawn.values())


def test_a_run_whose_filter_diverged_is_said_so(scenario: LoadedScenario, tmp_path: Path) -> None:
    _store(scenario, tmp_path, ["simulate", "recover", "filter", "assess"])
    results = _there(scenario, tmp_path)
    errors = assessed(results) | {("y", "only"): _result(np.full((3, 3), 5.0))}
    x, y, _ = single_runs(scenario, results, errors)
    assert x.context.endswith("run 0")
    assert y.context.endswith("run 0 (its filter diverged)")


def test_drawing_is_loaded_only_where_it_is_needed() -> None:
    script = (
        "import sys, debrisest.cli, debrisest.runner.sweep\n"
        "assert 'matplotlib' not in sys.modules\n"
        "import debrisest.show.plots.draw\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
