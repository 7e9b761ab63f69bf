"""Every family of problems estimates from a file of measurements, without a truth."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from debrisest.catalog import CATALOG
from debrisest.errors import UserError
from debrisest.results import store
from debrisest.roles import SimulationPart
from debrisest.scenario.document import parse
from debrisest.scenario.load import LoadedScenario, load_scenario
from debrisest.scenario.resolved import resolved

SIMULATED = [part for parts in CATALOG.values() for part in parts]
TOLD = {
    name
    for part in SIMULATED
    if issubclass(part, SimulationPart)
    for name in (*part.knows, *part.measures, "feature", "time_s", "run")
}
POINTS: dict[str, Any] = {
    "start": {
        "kind": "first_points",
        "variance": {"attitude_rad2": 1.0, "rate_rad2_s2": 0.1, "log_inertia": 0.16},
    },
    "problem": {"kind": "tumbling_points"},
    "filter": {"kind": "replay"},
}
# scenario: its case, its duration, the estimators, and what else is sought
FAMILIES: dict[str, tuple[str, float, list[str], set[str]]] = {
    "first_steps": ("noise_m=0.01", 60.0, ["wahba", "points"], set()),
    "pesce2017": ("A-deg", 12.0, ["reproduction", "best", "smoother", "pixels_only"], set()),
    "volpe2017": ("nominal", 60.0, ["reproduction", "online"], set()),
    "li2011": (
        *("bias", 72.0, ["reproduction", "bias"]),
        {"orbit_position", "orbit_velocity"},
    ),
}
NIS = {"table": "nis", "title": "NIS", "stage": "filter", "quantities": ["nis"]}
TABLES = {"layout": [NIS | {"statistics": ["mean"], "windows": ["end"]}]}


def estimators(text: dict[str, Any], names: list[str]) -> dict[str, Any]:
    every = text["estimators"] | {"points": POINTS}
    chosen = {name: dict(every[name]) for name in names}
    for one in chosen.values():
        one.pop("cases", None)
        one.pop("bound", None)
        one["filter"] = {k: v for k, v in one["filter"].items() if k != "keep_s"}
    return chosen


def told(path: Path, sought: set[str]) -> dict[str, np.ndarray]:
    """What a simulation leaves without its truth."""
    wanted = TOLD - sought
    data = store.read(path)
    return {name: v for name, v in data.items() if name.removesuffix("_sigma") in wanted}


def write_measured(path: Path, data: dict[str, np.ndarray], **attributes: Any) -> None:
    store.write(path, data, {"stage": "simulate"} | attributes)


@pytest.fixture(scope="module", params=FAMILIES)
def family(
    request: pytest.FixtureRequest, shipped: Path, tmp_path_factory: pytest.TempPathFactory,
    sweep: Callable,
) -> tuple[Path, str, list[str], set[str]]:  # fmt: skip
    """A simulation, and a scenario of its measurements beside it."""
    case, duration, names, sought = FAMILIES[request.param]
    folder = tmp_path_factory.mktemp(request.param)
    text = parse((shipped / f"{request.param}.yaml").read_text(), "shipped")[0].value
    chosen = estimators(text, names)
    simulated = text | {"duration_s": duration, "estimators": chosen, "tables": TABLES}
    if "cases" in text:
        changed = {k: v for k, v in text["cases"][case].items() if k != "estimators"}
        simulated["cases"] = {case: changed}
    (folder / "simulated.yaml").write_text(yaml.safe_dump(simulated, sort_keys=False))
    result = sweep(folder / "simulated.yaml", folder, "--case", case, "--runs", 2)
    assert result.exit_code == 0, result.output
    data = told(folder / "simulated" / case / "simulate.000000.h5", sought)
    write_measured(folder / "tracks.h5", data)
    measured = {"kind": "datasets", "file": "tracks.h5"}
    scenario = {"title": "measured", "measured": measured, "estimators": chosen, "tables": TABLES}
    (folder / "measured.yaml").write_text(yaml.safe_dump(scenario, sort_keys=False))
    return folder, case, names, sought


def test_the_estimates_are_those_of_the_simulation(
    family: tuple[Path, str, list[str], set[str]], sweep: Callable
) -> None:
    folder, case, names, _ = family
    result = sweep(folder / "measured.yaml", folder)
    assert result.exit_code == 0, result.output
    for name in names:
        assert f"Estimates: measured nominal, {name}, run 0, at " in result.stdout
    results = folder / "measured" / "nominal"
    assert not [name for name in store.read(results / "simulate.000000.h5") if "true" in name]
    for name in names:
        file = f"filter-{name}.000000.h5"
        found, expected = (store.read(out / file) for out in (results, folder / "simulated" / case))
        assert found.pop("failure").tolist() == ["", ""]
        assert found["status"].tolist() == expected["status"].tolist()
        for key, values in found.items():
            if values.dtype.kind == "f":
                np.testing.assert_allclose(values, expected[key], rtol=1e-12, atol=1e-12)
        assert expected.keys() - found.keys() <= {"failure", "cost_of_truth", "square_half_way"}
        assessed = store.read(results / f"assess-{name}.000000.h5")
        assert assessed.keys() & {"nis", "position_spread"}
        assert not assessed.keys() & {"rate", "position", "attitude", "nees"}


def loaded(folder: Path, **changes: Any) -> LoadedScenario:
    text = yaml.safe_load((folder / "measured.yaml").read_text())
    path = folder / "changed.yaml"
    path.write_text(yaml.safe_dump(text | changes, sort_keys=False))
    return load_scenario(path)


@pytest.fixture(scope="module")
def tumbling(tmp_path_factory: pytest.TempPathFactory, sweep: Callable, shipped: Path) -> Path:
    """A short simulation of the first steps, and a scenario of its measurements."""
    folder = tmp_path_factory.mktemp("tumbling")
    text = parse((shipped / "first_steps.yaml").read_text(), "shipped")[0].value
    chosen = estimators(text, ["points"])
    simulated = text | {"duration_s": 30, "estimators": chosen, "tables": TABLES, "grid": {}}
    (folder / "simulated.yaml").write_text(yaml.safe_dump(simulated, sort_keys=False))
    assert sweep(folder / "simulated.yaml", folder, "--runs", 2).exit_code == 0
    write_measured(folder / "tracks.h5", told(_simulation(folder), set()))
    measured = {"kind": "datasets", "file": "tracks.h5"}
    scenario = {"title": "measured", "measured": measured, "estimators": chosen, "tables": TABLES}
    (folder / "measured.yaml").write_text(yaml.safe_dump(scenario, sort_keys=False))
    return folder


def _simulation(folder: Path) -> Path:
    return folder / "simulated" / "nominal" / "simulate.000000.h5"


def test_the_data_tell_runs_and_length(tumbling: Path) -> None:
    case = loaded(tumbling).cases["nominal"]
    assert (case.scenario.runs, case.scenario.duration_s) == (2, 30.0)
    assert (case.runs(None), case.runs(1), case.runs(9)) == (2, 1, 2)
    assert "duration_s" not in yaml.safe_load(resolved(case))


def test_both_measured_and_simulated_is_a_mistake(tumbling: Path) -> None:
    with pytest.raises(UserError) as refused:
        loaded(tumbling, seed=1, sensors={"points": {"kind": "feature_points", "noise_m": 1}})
    assert len(refused.value.problems) == 2
    assert "seed: measured data stand in its place; leave it out" in refused.value.problems[0]


def test_what_the_data_lack_is_told_with_who_gives_it(tumbling: Path, shipped: Path) -> None:
    text = parse((shipped / "pesce2017.yaml").read_text(), "shipped")[0].value
    with pytest.raises(UserError, match=r"stereo_pose needs baseline.*sensors stereo_camera"):
        loaded(tumbling, estimators=estimators(text, ["best"]))


def test_a_bound_of_measured_data_is_refused(tumbling: Path) -> None:
    bound = POINTS | {"filter": {"kind": "efficient"}}
    with pytest.raises(UserError, match=r"efficient is linearised at the truth, but true_q_ib"):
        loaded(tumbling, estimators={"bound": bound})


def test_a_guess_is_not_drawn_about_no_truth(tumbling: Path) -> None:
    starts = {"guess": {"kind": "drawn_orbit", "position_sigma_m": 1.0, "velocity_sigma_m_s": 1.0}}
    with pytest.raises(UserError, match=r"drawn_orbit needs orbit_position.*measured data lack"):
        data = told(_simulation(tumbling), {"orbit_position", "orbit_velocity"})
        write_measured(tumbling / "bare.h5", data)
        loaded(tumbling, measured={"kind": "datasets", "file": "bare.h5"}, starts=starts)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "is missing; give a file"),
        (b"not HDF5", "is not a checkpoint of debrisest; give a file"),
        ({"stage": "filter"}, "is a file of the stage filter; give a file"),
        ({"time_s": [3.0, 2.0]}, "is truncated or damaged; give a file"),
        ({"start_position": [[1.0, 2.0, 3.0]]}, "start_position needs start_position_sigma"),
        ({"measured_range": [[1.0, 2.0, 3.0]]}, "measured_range has 3 values along time_s, not 2"),
    ],
)
def test_a_file_that_is_wrong_is_told(tumbling: Path, content: Any, words: str) -> None:
    path = tumbling / "wrong.h5"
    path.unlink(missing_ok=True)
    if isinstance(content, bytes):
        path.write_bytes(content)
    elif content is not None:
        stage = {key: content[key] for key in ("stage",) if key in content}
        data = {"run": np.zeros(1), "time_s": np.arange(2.0)}
        data |= {key: np.array(v) for key, v in content.items() if key != "stage"}
        write_measured(path, data, **stage)
    with pytest.raises(UserError, match=words):
        loaded(tumbling, measured={"kind": "datasets", "file": "wrong.h5"})


def test_a_changed_file_is_computed_again(tumbling: Path, sweep: Callable) -> None:
    assert sweep(tumbling / "measured.yaml", tumbling).exit_code == 0
    again = sweep(tumbling / "measured.yaml", tumbling, "--dry-run")
    assert "nothing" in again.output or "simulate" not in again.output
    data = store.read(tumbling / "tracks.h5")
    data["measured_point"][0, 0, 0, 0] = 1e-3
    write_measured(tumbling / "tracks.h5", data)
    after = sweep(tumbling / "measured.yaml", tumbling, "--dry-run")
    assert "measured.digest was" in after.output


@pytest.mark.parametrize("own_times", [True, False])
def test_epochs_may_be_uneven(tumbling: Path, sweep: Callable, own_times: bool) -> None:
    """The rate from epochs of which some are left out; with the times of an even grid it is off."""
    data = told(_simulation(tumbling), set())
    kept = np.sort(np.random.default_rng(2).permutation(30)[:20])
    times = kept if own_times else np.arange(20)
    needed = {name: data[name] for name in ("run", "feature", "known_point_f", "point_noise")}
    shown = {"time_s": times.astype(float), "measured_point": data["measured_point"][:, kept]}
    write_measured(tumbling / "uneven.h5", needed | shown)
    text = yaml.safe_load((tumbling / "measured.yaml").read_text())
    text["measured"]["file"] = "uneven.h5"
    (tumbling / "uneven.yaml").write_text(yaml.safe_dump(text, sort_keys=False))
    result = sweep(tumbling / "uneven.yaml", tumbling)
    assert result.exit_code == 0, result.output
    found = store.read(tumbling / "uneven" / "nominal" / "filter-points.000000.h5")
    truth = store.read(_simulation(tumbling))["true_rate_b"][:, kept[-1]]
    share = np.linalg.norm(found["rate_b"][:, -1], axis=-1) / np.linalg.norm(truth, axis=-1)
    assert (np.abs(share - 1) < 0.02).all() == own_times
