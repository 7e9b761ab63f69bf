"""Points of a grid that differ in estimators alone are one truth, simulated once."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from debrisest.errors import UserError
from debrisest.results.open import find_results
from debrisest.runner import sweep as sweeping
from debrisest.runner.plan import plan
from debrisest.runner.selection import Selection
from debrisest.scenario.load import load_scenario

NOISES = [round(1e-4 * 1.1**index, 8) for index in range(20)]
OF_FILTERS = f"grid: {{estimators.triad.problem.measurement_noise: {NOISES}}}\n"
SIMULATIONS = "sensors.points.noise_m: [0.01, 0.02]"
OF_BOTH = "grid:\n  estimators.triad.problem.measurement_noise: [1e-4, 2e-4]\n  " + SIMULATIONS
ONE_RUN = ("--estimator", "triad", "--runs", 1)


@pytest.fixture
def with_grid(small: Path) -> Callable:
    """The small scenario with a grid, and without what names its cases."""

    text = small.read_text().replace("  published: small.csv\n", "")
    text = text.replace("[slow, fast]", "[]")

    def write(grid: str) -> Path:
        small.write_text(f"{text}\n{grid}\n")
        return small

    return write


@pytest.fixture
def computed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of the steps that are computed."""
    names: list[str] = []
    original = sweeping.execute

    def execute(*given: object) -> object:
        for outcome in original(*given):
            names.append(outcome.step.name)
            yield outcome

    monkeypatch.setattr(sweeping, "execute", execute)
    return names


def test_twenty_settings_of_a_filter_simulate_once(
    with_grid: Callable, tmp_path: Path, sweep: Callable, computed: list[str], cli: Callable
) -> None:
    path, out = with_grid(OF_FILTERS), tmp_path / "out"
    assert sweep(path, out, *ONE_RUN).exit_code == 0
    simulated = [name for name in computed if "simulate" in name]
    assert simulated == ["small slow: simulate, runs 0-0", "small fast: simulate, runs 0-0"]
    assert len([name for name in computed if "filter" in name]) == 40
    results = find_results(out / "small")
    assert len(results.cases) == 40 and results.left_out == []
    one, other = (f"slow,measurement_noise={noise}" for noise in NOISES[:2])
    assert (results.load(one)["measured_point"] == results.load(other)["measured_point"]).all()
    rates = [results.one_run(case, "triad", 0)["rate_b"] for case in (one, other)]
    assert not np.array_equal(*rates)
    told = cli("status", path, "--out", out, *ONE_RUN).stdout.splitlines()
    assert "small slow, simulation: 1 runs there, 1 wanted, up to date" in told
    (out / "small" / one / "filter-triad.000000.h5").unlink()
    computed.clear()
    assert sweep(path, out, *ONE_RUN).exit_code == 0
    assert [name.partition(" triad")[0] for name in computed] == [
        f"small {one}: {stage}" for stage in ("filter", "assess")
    ]


def test_grids_over_both_simulate_each_truth(with_grid: Callable, tmp_path: Path) -> None:
    scenario = load_scenario(with_grid(OF_BOTH))
    steps = plan(scenario, tmp_path, Selection(runs=1, cases=list(scenario.cases)[:4]))
    simulated = [step.path.parent.name for step in steps if step.address.stage == "simulate"]
    assert simulated == ["slow,noise_m=0.01", "slow,noise_m=0.02"]
    assert "slow,measurement_noise=0.0002,noise_m=0.01" in scenario.cases


def test_a_selected_case_shares_with_those_that_follow(
    with_grid: Callable, tmp_path: Path, sweep: Callable, computed: list[str]
) -> None:
    path, out = with_grid(OF_FILTERS), tmp_path / "out"
    for noise in NOISES[-2:]:
        sweep(path, out, *ONE_RUN, "--case", f"slow,measurement_noise={noise}")
    assert len([name for name in computed if "simulate" in name]) == 1


@pytest.mark.parametrize("stage", ["simulate", "filter-triad"])
def test_what_is_stored_runs_again_by_itself(
    stage: str, with_grid: Callable, tmp_path: Path, sweep: Callable, cli: Callable
) -> None:
    path, case = with_grid(OF_FILTERS), f"slow,measurement_noise={NOISES[3]}"
    sweep(path, tmp_path / "out", *ONE_RUN, "--case", case)
    folder = tmp_path / "out" / "small" / ("slow" if stage == "simulate" else case)
    told = cli("rerun", folder / f"{stage}.000000.h5")
    assert (told.exit_code, told.stderr) == (0, ""), told.stdout
    assert "same bytes" in told.stdout


def test_common_draws_make_smooth_curves(with_grid: Callable, tmp_path: Path) -> None:
    """With them the noise of points is the same draw at another scale; without, another draw."""
    noises = {}
    for common in ("false", "true"):
        path = with_grid(f"common_draws: {common}\ngrid: {{{SIMULATIONS}}}")
        out = tmp_path / common
        scenario = load_scenario(path)
        selection = Selection(1, list(scenario.cases)[:2], last_stage="simulate")
        sweeping.bring_up_to_date([scenario], out, selection, sweeping.Machine(quiet=True))
        results = find_results(out / "small")
        points = [results.load(case)["measured_point"] for case in results.cases]
        exact = _exact(with_grid, tmp_path / f"{common}-exact")
        noises[common] = [point - exact for point in points]
    small, large = noises["true"]
    np.testing.assert_allclose(large, 2 * small, atol=1e-12)
    assert not np.allclose(*noises["false"])


def _exact(with_grid: Callable, out: Path) -> np.ndarray:
    scenario = load_scenario(with_grid(""), ["sensors.points.noise_m=1e-15"])
    selection = Selection(1, ["slow"], last_stage="simulate")
    sweeping.bring_up_to_date([scenario], out, selection, sweeping.Machine(quiet=True))
    return find_results(out / "small").load("slow")["measured_point"]


def test_cases_share_draws_by_a_name(small: Path) -> None:
    same = load_scenario(small, ["draws=one"])
    assert {case.draws for case in same.cases.values()} == {"one"}
    assert {case.draws for case in load_scenario(small).cases.values()} == {"slow", "fast"}


def test_common_draws_need_a_grid(small: Path) -> None:
    small.write_text(small.read_text() + "common_draws: true\n")
    with pytest.raises(UserError, match=r"small.yaml:\d+:1: common_draws: .*grid"):
        load_scenario(small)


def test_keys_that_end_alike_are_told_apart(with_grid: Callable) -> None:
    values = ["{kind: extended}", "{kind: unscented, alpha: 1}", "{kind: unscented, alpha: 0.5}"]
    grid = {
        "estimators.triad.problem.measurement_noise": "[1, 2]",
        "estimators.wahba.problem.measurement_noise": "[1]",
        "estimators.triad.filter": f"[{', '.join(values)}]",
    }
    lines = [f"  {key}: {value}" for key, value in grid.items()]
    scenario = load_scenario(with_grid("\n".join(["grid:", *lines])))
    names = [name for name in scenario.cases if name.startswith("slow")]
    first = "slow,triad.measurement_noise=1,wahba.measurement_noise=1"
    assert names[:3] == [
        f"{first},filter={told}" for told in ("extended", "unscented-2", "unscented-3")
    ]
