"""A slip is told with what was probably meant, wherever a name, a window or a word is given."""

from collections.abc import Callable
from pathlib import Path

import pytest

STARTS = "starts: {guess: {kind: given, quantities: {rate_b: {value: [1, 2, 3], sigma: 1}}}}\n"


@pytest.fixture
def steps(tmp_path: Path, shipped: Path) -> Path:
    """The first steps with a start that is given, for a test to change."""
    text = (shipped / "first_steps.yaml").read_text(encoding="utf-8")
    (tmp_path / "steps.yaml").write_text(text.replace("tables:\n", STARTS + "tables:\n"))
    return tmp_path / "steps.yaml"


IN_FILES = [
    ("[200-300 s]", "[200-300s]", "200-300 s"),
    ("[200-300 s]", "[200 to 300]", "200-300 s"),
    ("[200-300 s]", "[50 sec]", "50 s"),
    ("[200-300 s]", "[ned]", "end"),
    ("[200-300 s]", "[Start]", "start"),
    ("[pitch, attitude]", "[pitch, atitude]", "attitude"),
    ("[pitch, attitude]", "[pitch]\n      units: {pitch: mard}", "mrad"),
    ("[pitch, attitude]", "[pitch]\n      units: {ptich: deg}", "pitch"),
    ("[rmse]", "[rsme]", "rmse"),
    ("stage: recover", "stage: recovr", "recover"),
    ("  wahba:\n", "  wahba:\n    bound: whaba\n", "wahba"),
    ("kind: unscented", "kind: unscentd", "unscented"),
    ("runs: 5", "run: 5", "runs"),
    ("seed: 7", "seed: 7\nrate_deg_s: [1, 2, 3]", "motion.rate_deg_s"),
    ("sensors.points.noise_m:", "sensors.points.nois_m:", "noise_m"),
    ("sensors.points.noise_m:", "sensors.point.noise_m:", "points"),
    ("grid:", "cases:\n  a: {observers: {chasr: {position_m: [0, 9, 0]}}}\ngrid:", "chaser"),
    ("grid:", "cases:\n  a: {estimators: {whaba: {filter: {kind: extended}}}}\ngrid:", "wahba"),
    ("grid:", "cases:\n  a: {motions: {rate_deg_s: [1, 2, 3]}}\ngrid:", "motion"),
    ("tables:", "tables:\n  means: {all: [noise_m=0.3]}", "noise_m=0.03"),
    ("tables:", "tables:\n  published: step.csv", "steps.csv"),
    ("rate_b:", "rateb:", "rate_b"),
    ("sigma: 1}", "sigma: 1, unit: deg/sec}", "deg/s"),
]


@pytest.mark.parametrize(("right", "wrong", "said"), IN_FILES)
def test_slips_in_files(right: str, wrong: str, said: str, steps: Path, cli: Callable) -> None:
    steps.with_suffix(".csv").write_text("")
    text = steps.read_text()
    assert right in text
    steps.write_text(text.replace(right, wrong, 1))
    result = cli("validate", steps)
    assert result.exit_code == 2
    assert f"(did you mean {said}?)" in result.output, result.output


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--set", "noise_m=1"], "sensors.points.noise_m"),
        (["--set", "sensor.points.noise_m=1"], "sensors"),
        (["--set", "sensors.point.noise_m=1"], "points"),
        (["--set", "sensors.points.nois_m=1"], "noise_m"),
        (["--set", "estimators.wahba.filter.kind=extnded"], "extended"),
        (["--case", "noise_m=0.3"], "noise_m=0.03"),
        (["--estimator", "whaba"], "wahba"),
        (["--format", "cvs"], "csv"),
    ],
)
def test_slips_in_options(arguments: list[str], said: str, steps: Path, cli: Callable) -> None:
    result = cli("table", steps, *arguments)
    assert result.exit_code == 2
    assert f"(did you mean {said}?)" in result.output, result.output


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["plot", "steps.yaml", "--figure", "rate"], "rates"),
        (["plot", "steps.yaml", "--format", "pgn"], "png"),
        (["sweep", "step.yaml"], "steps.yaml"),
        (["sweep", "first_step"], "first_steps"),
    ],
)
def test_slips_in_names_of_files_and_figures(
    arguments: list[str], said: str, steps: Path, cli: Callable, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(steps.parent)
    result = cli(*arguments)
    assert result.exit_code == 2
    assert f"(did you mean {said}?)" in result.output, result.output


def test_what_is_like_nothing_is_told_without_a_guess(steps: Path, cli: Callable) -> None:
    result = cli("validate", steps, "--set", "zzz=1")
    assert "did you mean" not in result.output
    result = cli("validate", steps, "--set", "tables.scored_window=900-400 s")
    assert "did you mean" not in result.output
