"""Numbers that no experiment has are refused at their place, before a formula overflows."""

from pathlib import Path
from typing import Any

import pytest

from debrisest.scenario import document
from debrisest.scenario.limits import extreme_numbers

REFUSED = [
    "target.points.b.normal=[1e300, 1, 0]", "target.points.b.position_m=[0, 1e-200, 1e13]",
    "motion.rate_deg_s=[1e6, 0, 0]", "estimators.wahba.filter.alpha=1e160",
    "estimators.wahba.problem.measurement_noise=1e-200", "orbit.semi_major_axis_km=1e300",
    "sensors.points.noise_m=1e308", "target.inertia_kg_m2=[1e-150, 1, 1]",
    f"target.inertia_kg_m2=[{10**40}, 1, 1]", "observers.chaser.position_m=[0, 30, -1e30]",
]  # fmt: skip


@pytest.mark.parametrize("setting", REFUSED)
def test_extreme_numbers_are_refused_where_they_stand(setting: str, small: Path, cli: Any) -> None:
    result = cli("validate", small, "--set", setting)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"--set {setting}: {setting.partition('=')[0]}")
    assert "is possible here" in result.stderr


def test_each_is_told_with_its_line_in_cases_and_grids_too(small: Path, cli: Any) -> None:
    text = small.read_text().replace("fast: {}", "fast: {motion: {rate_deg_s: [1e9, 0, 0]}}")
    small.write_text(text + "grid:\n  sensors.points.noise_m: [1, 1e99]\n")
    lines = cli("validate", small).stderr.splitlines()
    assert len(lines) == 2
    assert "cases.fast.motion.rate_deg_s.0: at most 10000" in lines[0]
    assert "grid.sensors.points.noise_m.1: at most 1e+12" in lines[1]


def test_what_experiments_have_is_possible() -> None:
    ordinary = {"seed": 2**63 - 1, "a": 0.0, "b": [1e-24, -3], "alpha": 1e-3, "flag": True}
    assert not list(extreme_numbers({"x": ordinary, "duration_s": 1e10, "rate_rad2_s2": 1e300}))


@pytest.mark.parametrize("runs", [10**7, 10**30])
def test_runs_are_limited(runs: int, small: Path, cli: Any) -> None:
    told = cli("validate", small, "--set", f"runs={runs}")
    assert told.exit_code == 2
    asked = cli("sweep", small, "--runs", runs, "--dry-run")
    assert asked.exit_code == 2
    assert f"--runs {runs}: from 1 to 1000000" in asked.stderr or runs > 2**63


def test_aliases_of_aliases_end_in_a_sentence(small: Path, cli: Any) -> None:
    """Under 500 bytes that stand for ten to the tenth values."""
    bomb = "a0: &a0 [1]\n" + "".join(
        f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 11)
    )
    small.write_text(bomb)
    result = cli("validate", small)
    assert result.exit_code == 2
    assert "aliases" in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_a_grid_of_far_too_many_cases_is_refused_before_it_is_made(small: Path, cli: Any):
    keys = ("sensors.points.noise_m", "duration_s", "seed", "estimators.wahba.recovery.penalty")
    values = list(range(1, 101))
    small.write_text(small.read_text() + "grid:\n" + "".join(f"  {k}: {values}\n" for k in keys))
    done = cli("validate", small)
    assert done.exit_code == 2
    assert f"{small}:78:" in done.stderr and "makes 200000000 cases" in done.stderr


def test_of_mistakes_without_end_the_first_are_told(small: Path, cli: Any) -> None:
    small.write_text(small.read_text() + "".join(f"unknown_{n}: 1\n" for n in range(5000)))
    done = cli("validate", small)
    assert done.exit_code == 2
    assert "and 4900 more mistakes; mend these first" in done.stderr
    assert "unknown_99" in done.stderr and "unknown_100:" not in done.stderr


def large(small: Path) -> str:
    """The small scenario with so many cases that its text is read by the quick loader."""
    before = small.read_text().replace("  published: small.csv\n", "").partition("cases:")[0]
    cases = [f"  c{k}: {{motion: {{rate_deg_s: [{k}e-2, 2, -1]}}}}" for k in range(2500)]
    text = "\n".join([before.replace("mean: [slow, fast]", "mean: [c1, c2]"), "cases:", *cases])
    assert len(text) > document._LARGE
    return text


@pytest.mark.parametrize(
    ("old", "new"), [("", ""), ("c7:", "ω7:"), ("c9:", "c8:"), ("c9: {", "c9: {{"), ("2,", "\t2,")]
)
def test_a_large_file_is_read_as_a_small_one_is(
    old: str, new: str, small: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = large(small).replace(old, new, 1)
    quick = document.parse(text, "x.yaml")
    monkeypatch.setattr(document, "_LARGE", 10**9)
    assert document.parse(text, "x.yaml") == quick


def test_a_mistake_in_one_of_many_cases_has_its_line(small: Path, cli: Any) -> None:
    text = large(small)
    line = text[: text.index("c2040:")].count("\n") + 1
    small.write_text(text.replace("[2040e-2, 2, -1]", "[2040e-2, 2]"))
    told = cli("validate", small).stderr
    assert told.startswith(f"{small}:{line}:")
    assert len(told.splitlines()) == 1
