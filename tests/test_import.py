"""debrisest import: the files that it writes, their results, and what it refuses."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from debrisest.results import store
from tests.measured_motion import cells, csv, seen_by_chaser, write_files

COMPARED = ("printed", "reproduction", "wahba")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_files(tmp_path)
    return tmp_path


def problem_of(path: Path) -> dict[str, Any]:
    return yaml.safe_load(path.read_text())["estimators"]["batch"]


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory, shipped: Path, sweep: Callable) -> Path:
    """One run of a shipped scenario, and its points as a person would have them."""
    out = tmp_path_factory.mktemp("simulated")
    chosen = [word for name in COMPARED for word in ("--estimator", name)]
    config = shipped / "biondi2017.yaml"
    assert sweep(config, out, "--case", 1, "--runs", 1, *chosen).exit_code == 0
    data = store.read(out / "biondi2017" / "1" / "simulate.000000.h5")
    rows = [
        (repr(time), name, *map(repr, point.tolist()))
        for time, points in zip(data["time_s"].tolist(), data["measured_point"][0])
        for name, point in zip(data["feature"], points)
        if not np.isnan(point).any()
    ]
    csv(out / "points.csv", "time_s,feature,x_m,y_m,z_m", rows)
    return out


def test_the_estimates_are_those_of_the_simulation(
    simulated: Path, shipped: Path, cli: Callable, sweep: Callable
) -> None:
    config = shipped / "biondi2017.yaml"
    done = cli("import", simulated / "points.csv", "--scenario", config, "--noise-m", 0.05)
    assert done.exit_code == 0, done.output
    assert "left out: bound, smoother_bound: efficient is linearised at the truth" in done.output
    written = simulated / "points.yaml"
    assert f"next: debrisest sweep {written}" in done.output
    assert cli("validate", written).exit_code == 0
    chosen = [word for name in COMPARED for word in ("--estimator", name)]
    assert sweep(written, simulated, *chosen).exit_code == 0
    data = store.read(simulated / "points.h5")
    assert not [name for name in data if name.startswith("true_")] and "notes" in data
    for name in COMPARED:
        file = f"filter-{name}.000000.h5"
        found = store.read(simulated / "points" / "nominal" / file)
        expected = store.read(simulated / "biondi2017" / "1" / file)
        assert found.keys() == expected.keys()
        for key, values in found.items():
            np.testing.assert_array_equal(values, expected[key], err_msg=f"{name} {key}")


@pytest.mark.parametrize(
    ("file", "options", "expected"),
    [
        ("points.csv", [], {"problem": {"geometry": "unknown"}}),
        ("points.csv", ["--points"], {"problem": {}}),
        ("poses.csv", [], {"problem": {"measured": "attitudes"}}),
        (
            *("pixels.csv", ["--camera", "--points"]),
            {"recovery": {"kind": "pixel_pose"}, "problem": {"measured": "attitudes"}},
        ),
        (
            *("pixels.csv", ["--camera"]),
            {"recovery": {"kind": "triangulation"}, "problem": {"geometry": "unknown"}},
        ),
    ],
)
def test_the_default_estimator_finds_the_rate_of_the_motion(
    folder: Path, cli: Callable, sweep: Callable,
    file: str, options: list[str], expected: dict[str, Any],
) -> None:  # fmt: skip
    """Of a chaser and a body that both turn: 8 deg/s, whatever was measured."""
    files = {"--points": folder / "body.csv", "--camera": folder / "stereo.yaml"}
    given = [word for option in options for word in (option, files[option])]
    attitude = ("--attitude", folder / "attitude.csv")
    noise = {"poses.csv": "--sigma-deg", "pixels.csv": "--noise-px"}.get(file, "--noise-m")
    done = cli("import", folder / file, *given, *attitude, noise, 0.01)
    assert done.exit_code == 0, done.output
    path = (folder / file).with_suffix(".yaml")
    expected = expected | {"filter": {"kind": "batch"}}
    expected["problem"] = {"kind": "tumbling_motion", **expected["problem"]}
    assert problem_of(path) == expected
    assert cli("validate", path).exit_code == 0
    assert sweep(path, folder).exit_code == 0
    found = store.read(folder / path.stem / "nominal" / "filter-batch.000000.h5")
    off = np.abs(found["speed_end"] - np.radians(8.0))
    assert (off < 5 * found["speed_end_sigma"] + 1e-9).all()
    assert (found["speed_end_sigma"] < np.radians(0.1)).all()


def test_nothing_is_overwritten_unless_forced(folder: Path, cli: Callable) -> None:
    assert cli("import", folder / "points.csv").exit_code == 0
    before = (folder / "points.yaml").read_bytes()
    again = cli("import", folder / "points.csv", "--points", folder / "body.csv")
    assert again.exit_code == 2
    assert "points.h5: this file is there already" in again.output
    assert (folder / "points.yaml").read_bytes() == before
    forced = cli("import", folder / "points.csv", "--points", folder / "body.csv", "--force")
    assert forced.exit_code == 0 and (folder / "points.yaml").read_bytes() != before


def test_a_scenario_never_takes_the_place_of_its_model(
    folder: Path, cli: Callable, shipped: Path
) -> None:
    own = folder / "points.yaml"
    own.write_bytes((shipped / "first_steps.yaml").read_bytes())
    done = cli("import", folder / "points.csv", "--scenario", own, "--force")
    assert done.exit_code == 2 and "would take its place" in done.output
    assert own.read_bytes() == (shipped / "first_steps.yaml").read_bytes()


def test_tables_and_times_that_the_data_do_not_reach_are_left_out(
    folder: Path, cli: Callable, sweep: Callable, shipped: Path
) -> None:
    """Of a scenario of 300 s whose filters keep a covariance late, for data of 15 s."""
    text = yaml.safe_load((shipped / "first_steps.yaml").read_text())
    points = seen_by_chaser()
    names = ["front_1", "front_2", "back_1", "left", "top"]
    rows = ((time, dict(zip(("bow", "left", "right", "tail", "top"), names))[name], *point)
            for time, name, *point in cells(points))  # fmt: skip
    csv(folder / "mine.csv", "time_s,feature,x_m,y_m,z_m", rows)
    del text["grid"]
    for name, point in zip(names, (points[0] - points[0].mean(axis=0)).tolist()):
        text["target"]["points"][name]["position_m"] = point
    text["estimators"]["wahba"]["filter"]["keep_s"] = [5, 250]
    text["estimators"]["wahba"]["start"]["samples"] = 3
    (folder / "like.yaml").write_text(yaml.safe_dump(text))
    done = cli("import", folder / "mine.csv", "--scenario", folder / "like.yaml")
    assert done.exit_code == 0, done.output
    assert "2 tables or rules are left out: their windows are not in the data" in done.output
    written = yaml.safe_load((folder / "mine.yaml").read_text())
    assert written["estimators"]["wahba"]["filter"]["keep_s"] == [5.0]
    assert sweep(folder / "mine.yaml", folder).exit_code == 0


def test_one_camera_without_geometry_is_told_what_it_would_fit(folder: Path, cli: Callable) -> None:
    lines = (folder / "one.csv").read_text().splitlines()
    text = "\n".join([f"{lines[0]},range_m", *(f"{line},9.1" for line in lines[1:])])
    (folder / "one.csv").write_text(text + "\n")
    done = cli("import", folder / "one.csv", "--camera", folder / "mono.yaml")
    assert done.exit_code == 2
    assert "nothing can be estimated from pixels, ranges alone; what is missing" in done.output
    told = [line for line in done.output.splitlines() if "camera_range_minimal" in line]
    assert len(told) == 1 and "known_q_hc" in told[0] and "measured_pixel" not in told[0]
    assert not (folder / "one.h5").exists() and not (folder / "one.yaml").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--noise-m", -1], "noise_m: must be greater than 0"),
        (["--sigma-deg", 1], "it holds tracks, for which --sigma-deg is of no use"),
        (["--points", "none.csv"], "none.csv: there is no such file"),
        (["--scenario", "li2011"], "no estimator of .*li2011.yaml is left for these data"),
        (["--scenario", "volpe2017"], "none of its features, bow.* is in .*volpe2017.yaml"),
    ],
)
def test_wrong_input_is_told_and_nothing_is_written(
    folder: Path, cli: Callable, options: list[Any], words: str
) -> None:
    done = cli("import", folder / "points.csv", *options)
    assert done.exit_code == 2
    assert re.search(words, done.output), done.output
    assert not (folder / "points.h5").exists() and not (folder / "points.yaml").exists()


def test_the_shipped_examples_can_be_imported(tmp_path: Path, cli: Callable, shipped: Path) -> None:
    for name in ("tracks", "poses"):
        file = shipped / "examples" / f"{name}.csv"
        done = cli("import", file, "--out", tmp_path)
        assert done.exit_code == 0, done.output
        assert cli("validate", tmp_path / f"{name}.yaml").exit_code == 0
