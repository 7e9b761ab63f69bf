"""From a user's file to the answer: against the truth of the shipped examples, and every ending."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from scipy.spatial.transform import Rotation

from debrisest.arrays import Array, Data
from debrisest.results.open import open_results
from debrisest.show.answer import answer

TRUTH = Path(__file__).parent / "examples"
GUIDE = (Path(__file__).parent.parent / "docs" / "measured.md").read_text(encoding="utf-8")
LAST = slice(-1, None)


@pytest.fixture(scope="module", params=["tracks", "poses"])
def done(
    request: pytest.FixtureRequest, shipped: Path, tmp_path_factory: pytest.TempPathFactory,
    cli: Callable,
) -> tuple[str, Path, str]:  # fmt: skip
    """An example, the folder of its answer, and what was printed."""
    folder = tmp_path_factory.mktemp("answers") / request.param
    example = shipped / "examples" / f"{request.param}.csv"
    result = cli("estimate", example, "--out", folder, "--quiet")
    assert result.exit_code == 0, result.output
    return request.param, folder, result.stdout


def stored(folder: Path) -> Data:
    return open_results(folder).one_run("nominal", "batch", 0)


def rotations(q: Array) -> Rotation:
    return Rotation.from_quat(q, scalar_first=True)


def true_motion(name: str) -> tuple[Rotation, Array, Array]:
    """Attitudes, inertial rates and the moments over the largest."""
    truth = pd.read_csv(TRUTH / f"{name}_truth.csv")
    attitude = rotations(truth[["q0", "q1", "q2", "q3"]].to_numpy())
    moments = truth[["moment_1", "moment_2", "moment_3"]].iloc[0].to_numpy()
    return attitude, attitude.apply(truth[["w1", "w2", "w3"]].to_numpy()), moments / moments[-1]


def turn_sigma(data: Data) -> Array:
    """Root mean square of the attitude's error angle (time,), rad."""
    return 2.0 * np.linalg.norm(data["q_if_sigma"], axis=-1)


@pytest.mark.parametrize(("epochs", "sigmas"), [(LAST, 3.0), (slice(None), 5.0)])
def test_turns_and_inertial_rates_are_the_true_ones(
    done: tuple[str, Path, str], epochs: slice, sigmas: float
) -> None:
    """Whatever axes are fixed in the body: from the first epoch on."""
    name, folder, _ = done
    data, (attitude, rate, _) = stored(folder), true_motion(name)
    found, sigma = rotations(data["q_if"]), turn_sigma(data)
    turn, true_turn = found * found[0].inv(), attitude * attitude[0].inv()
    off = (turn * true_turn.inv()).magnitude()
    assert (off < sigmas * np.hypot(sigma, sigma[0]))[epochs].all()
    error = np.linalg.norm(found.apply(data["rate_f"]) - rate, axis=-1)
    of_rate = np.linalg.norm(data["rate_f_sigma"], axis=-1)
    limit = sigmas * np.hypot(of_rate, sigma * np.linalg.norm(rate, axis=-1))
    assert (error < limit)[epochs].all()


def test_attitude_and_rate_of_poses_are_in_the_body_axes_of_the_file(
    done: tuple[str, Path, str],
) -> None:
    name, folder, _ = done
    if name != "poses":
        pytest.skip("axes of unknown points are the estimator's own")
    data, (attitude, rate, _) = stored(folder), true_motion(name)
    off = (rotations(data["q_if"]) * attitude.inv()).magnitude()
    assert off[-1] < 3 * turn_sigma(data)[-1]
    error = data["rate_f"] - attitude.inv().apply(rate)
    assert (np.abs(error[-1]) < 3 * data["rate_f_sigma"][-1]).all()


def test_ratios_speed_and_momentum_are_the_true_ones(done: tuple[str, Path, str]) -> None:
    name, folder, _ = done
    data, (attitude, rate, share) = stored(folder), true_motion(name)
    assert data["accepted"] == 1
    off = np.abs(data["moment_share"] - share)[:2]
    assert (off < 3 * data["moment_share_sigma"][:2]).all()
    assert abs(data["speed_end"] - np.linalg.norm(rate[-1])) < 3 * data["speed_end_sigma"]
    momentum = attitude[0].apply(share * attitude[0].inv().apply(rate[0]))
    angle = np.arccos(data["momentum_axis_i"] @ momentum / np.linalg.norm(momentum))
    assert angle < 3 * np.linalg.norm(data["momentum_axis_i_sigma"])


def test_the_answer_is_that_of_the_files_that_are_named(done: tuple[str, Path, str]) -> None:
    _, folder, printed = done
    lines = printed.splitlines()
    assert "note: columns separated by commas" in lines
    told = answer(stored(folder))
    first = lines.index(told[0])
    assert lines[first : first + len(told)] == told
    assert 9 <= len(told) <= 13
    written = [Path(line.removeprefix("wrote ")) for line in lines if line.startswith("wrote ")]
    assert all(path.is_file() and folder in path.parents for path in written)
    assert {path.suffix for path in written} == {".yaml", ".h5", ".csv", ".png", ".svg"}
    assert folder / "plots" / "motion-nominal-batch.png" in written
    rows = pd.read_csv(folder / "estimates.csv")
    speed = rows[rows["quantity"] == "speed_end"]
    assert speed["value"].item() == pytest.approx(np.degrees(stored(folder)["speed_end"]))


def test_the_guide_shows_the_lines_of_the_answer(done: tuple[str, Path, str]) -> None:
    """With the words and labels of today; figures may differ in their last digits."""
    name, folder, _ = done
    if name != "tracks":
        pytest.skip("the guide shows the answer of the tracks")
    shown = GUIDE.partition("$ debrisest estimate tracks.csv\n")[2].partition("\n\n")[0]
    without_figures = [re.sub(r"[-\d.]+", "#", line.strip()) for line in shown.splitlines()]
    assert without_figures == [re.sub(r"[-\d.]+", "#", line) for line in answer(stored(folder))]


def test_the_scenario_does_the_same_through_sweep(
    done: tuple[str, Path, str], cli: Callable, tmp_path: Path
) -> None:
    name, folder, _ = done
    config = folder / f"{name}.yaml"
    again = cli("sweep", config, "--out", folder.parent, "--dry-run")
    assert again.stdout == "0 of 3 steps would run\n"
    assert cli("sweep", config, "--out", tmp_path, "--jobs", 1, "--quiet").exit_code == 0
    mine, theirs = (open_results(f / name).load("nominal", "batch", "filter")
                    for f in (folder.parent, tmp_path))  # fmt: skip
    np.testing.assert_array_equal(mine["q_if"], theirs["q_if"])


@pytest.fixture
def few(shipped: Path, tmp_path: Path) -> Path:
    """Some poses without their noise."""
    rows = pd.read_csv(shipped / "examples" / "poses.csv").drop(columns="sigma_deg")
    path = tmp_path / "few.csv"
    rows.iloc[:60].to_csv(path, index=False)
    return path


def test_another_scenario_is_not_replaced_unless_forced(
    few: Path, tmp_path: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Through a link to a folder elsewhere, too."""
    (tmp_path / "far" / "away").mkdir(parents=True)
    (tmp_path / "results").symlink_to(tmp_path / "far" / "away")
    monkeypatch.chdir(tmp_path)
    assert cli("estimate", few, "--quiet").exit_code == 0
    config = tmp_path / "results" / "few" / "few.yaml"
    assert cli("estimate", few, "--quiet").exit_code == 0
    refused = cli("estimate", few, "--sigma-deg", 1.5, "--quiet")
    assert refused.exit_code == 2
    assert "another scenario is there already" in refused.stderr
    assert "sigma_deg" not in config.read_text()
    assert cli("estimate", few, "--sigma-deg", 1.5, "--quiet", "--force").exit_code == 0
    assert yaml.safe_load(config.read_text())["measured"]["sigma_deg"] == 1.5


def test_no_motion_is_a_value_and_impossible_to_miss(
    few: Path, tmp_path: Path, cli: Callable
) -> None:
    rows = pd.read_csv(few)
    noise = Rotation.random(len(rows), np.random.default_rng(4)).as_quat()
    rows[["q0", "q1", "q2", "q3"]] = noise
    rows.to_csv(few, index=False)
    result = cli("estimate", few, "--out", tmp_path / "noise", "--sigma-deg", 1, "--quiet")
    assert result.exit_code == 0, result.output
    assert "\n\nNOT ACCEPTED: " in result.stdout
    assert "nan" not in result.stdout


def test_a_steady_spin_has_an_attitude_and_no_inertia(tmp_path: Path, cli: Callable) -> None:
    times = np.arange(0.0, 200.0, 4.0)
    turn = Rotation.from_rotvec(np.outer(0.03 * times, [0.0, 0.6, 0.8]))
    noise = Rotation.from_rotvec(0.01 * np.random.default_rng(7).standard_normal((len(times), 3)))
    rows = pd.DataFrame((noise * turn).as_quat(scalar_first=True), columns=["q0", "q1", "q2", "q3"])
    rows.insert(0, "time_s", times)
    rows.to_csv(tmp_path / "spin.csv", index=False)
    options = ("--sigma-deg", np.degrees(0.01), "--out", tmp_path / "spin", "--quiet")
    result = cli("estimate", tmp_path / "spin.csv", *options)
    assert "accepted: the body turns steadily about one axis" in result.stdout
    assert "\ninertia        the motion does not show them: it turns steadily" in result.stdout
    data = stored(tmp_path / "spin")
    sigma = turn_sigma(data)
    assert (sigma < np.sqrt(3) * 0.01).all()
    assert ((rotations(data["q_if"]) * turn.inv()).magnitude() < 4 * sigma).all()
    off = np.linalg.norm(np.cross(data["spin_axis_i"], [0.0, 0.6, 0.8]))
    assert off < 3 * np.linalg.norm(data["spin_axis_i_sigma"]) < 0.05


def test_three_epochs_are_too_few(few: Path, tmp_path: Path, cli: Callable) -> None:
    pd.read_csv(few).iloc[:3].to_csv(few, index=False)
    result = cli("estimate", few, "--out", tmp_path / "three", "--sigma-deg", 1, "--quiet")
    assert result.exit_code == 0, result.output
    assert "\nNOT ACCEPTED: too few data for a motion" in result.stdout


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (("few.csv", "--noise-m", 1), "--noise-m"),
        (("few.csv", "--sigma-deg", -1), "sigma_deg"),
        (("none.csv",), "none.csv"),
        (("few.csv", "--attitude", "none.csv"), "none.csv"),
    ],
)
def test_wrong_input_writes_nothing(
    given: tuple[object, ...], words: str, few: Path, tmp_path: Path, cli: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    result = cli("estimate", *given)
    assert result.exit_code == 2
    assert words in result.stderr
    assert not (tmp_path / "results").exists()
