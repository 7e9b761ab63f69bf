"""Bad input: one clear message each, with file, line and column, and nothing written."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from debrisest.errors import UserError
from debrisest.scenario.load import load_scenario

FEATURES = (
    "    b: {position_m: [0, 1.2, -0.4], normal: [0, 1, 0]}\n"
    "    c: {position_m: [-1.0, 0, 0.7], normal: [-1, 0, 0]}\n"
    "    d: {position_m: [0.3, -1.1, -0.2], normal: [0, -1, 0]}\n"
)
COLLINEAR = (
    "    b: {position_m: [1.0, 0, 1.5], normal: [0, 1, 0]}\n"
    "    c: {position_m: [1.0, 0, 2.5], normal: [-1, 0, 0]}\n"
    "    d: {position_m: [0.3, -1.1, -0.2], normal: [0, -1, 0]}\n"
)
SENSOR = "{kind: feature_points, noise_m: 1e-2, visibility: all}"

# name: (what is replaced, by what, what stands at the place told, words of the message)
BAD: dict[str, tuple[str, str, str, list[str]]] = {
    "unknown_key": (
        "step_s: 1\n", "step_s: 1\nstepp_s: 2\n", "stepp_s",
        ["unknown key", "did you mean step_s?"],
    ),
    "unknown_key_of_a_part": (
        "visibility: all", "visibilty: all", "visibilty", ["unknown key", "mean visibility?"],
    ),
    "misspelt_motion": (
        "kind: torque_free", "kind: torquefree", "kind: torquefree",
        ["motion.kind", "'torquefree'", "did you mean torque_free?", "gravity_gradient"],
    ),
    "misspelt_filter": (
        "kind: unscented", "kind: unscentd", "kind: unscentd",
        ["filter.kind", "'unscentd'", "did you mean unscented?"],
    ),
    "misspelt_choice": (
        "visibility: all", "visibility: al", "visibility: al", ["'al'", "did you mean all?"],
    ),
    "duplicate_key": (
        "runs: 3\n", "runs: 3\nseed: 8\n", "seed: 8", ["seed", "already given in line 3"],
    ),
    "nested_duplicate_key": (
        "noise_m: 1e-2", "noise_m: 1e-2, noise_m: 0.3", "noise_m: 0.3",
        ["already given in line 27"],
    ),
    "wrong_unit": (
        "noise_m: 1e-2", "noise_cm: 1", "noise_cm", ["unknown key", "did you mean noise_m?"],
    ),
    "triangle_inequality": (
        "[0.618, 0.707, 0.345]", "[0.1, 0.2, 0.9]", "inertia_kg_m2", ["triangle", "0.1, 0.2, 0.9"],
    ),
    "negative_moment": (
        "[0.618, 0.707, 0.345]", "[-0.1, 0.2, 0.2]", "inertia_kg_m2", ["positive"],
    ),
    "asymmetric_inertia": (
        "[0.618, 0.707, 0.345]", "[[1, 0.1, 0], [0, 1, 0], [0, 0, 1]]", "inertia_kg_m2",
        ["symmetric"],
    ),
    "zero_quaternion": (
        "kind: torque_free\n", "kind: torque_free\n  q_ib: [0, 0, 0, 0]\n", "q_ib: [0",
        ["motion.q_ib", "unit quaternion", "norm is 0"],
    ),
    "negative_noise": (
        "noise_m: 1e-2", "noise_m: -1e-2", "noise_m", ["greater than or equal to 0", "-0.01"],
    ),
    "two_features": (
        FEATURES, FEATURES.split("\n")[0] + "\n", "points:\n", ["three features", "found 2"],
    ),
    "features_on_a_line": (FEATURES, COLLINEAR, "points:\n", ["first three", "line"]),
    "zero_normal": (
        "normal: [1, 0, 0]", "normal: [0, 0, 0]", "normal: [0, 0, 0]", ["not be zero"],
    ),
    "text_for_a_number": ("seed: 7", "seed: seven", "seed", ["valid integer", "'seven'"]),
    "boolean_for_a_number": (
        "duration_s: 60", "duration_s: true", "duration_s", ["valid number", "True"],
    ),
    "boolean_for_a_count": ("runs: 3", "runs: true", "runs", ["valid integer", "True"]),
    "overflow": ("noise_m: 1e-2", "noise_m: 1e999", "noise_m", ["finite", "inf"]),
    "infinity": ("noise_m: 1e-2", "noise_m: .inf", "noise_m", ["number", ".inf"]),
    "not_a_number": ("noise_m: 1e-2", "noise_m: .nan", "noise_m", ["number", ".nan"]),
    "no_runs": ("runs: 3", "runs: 0", "runs", ["greater than or equal to 1"]),
    "half_a_run": ("runs: 3", "runs: 2.5", "runs", ["integer", "2.5"]),
    "list_for_a_key": (
        "seed: 7\n", "seed: 7\n? [1, 2]\n: 3\n", "[1, 2]\n", ["a key must be a text"],
    ),
    "mapping_for_a_key": (
        "noise_m: 1e-2", "noise_m: 1e-2, {a: 1}: 2", "{a: 1}", ["a key must be a text"],
    ),
    "nothing_given": ("seed: 7", "seed:", "seed", ["integer", "None"]),
    "two_components": (
        "rate_deg_s: [7.2, 5.5, -1.6]", "rate_deg_s: [7.2, 5.5]", "rate_deg_s: [7.2, 5.5]",
        ["at least 3 items"],
    ),
    "text_in_a_vector": (
        "[7.2, 5.5, -1.6]", "[7.2, five, -1.6]", "five", ["motion.rate_deg_s.1", "'five'"],
    ),
    "bad_case": (
        "slow: {motion: {rate_deg_s: [3.0, 2.0, -1.0]}}",
        "slow: {motion: {rate_rad_s: [3.0, 2.0, -1.0]}}", "rate_rad_s",
        ["motion.rate_rad_s", "unknown key", "did you mean rate_deg_s?"],
    ),
    "case_is_a_list": ("fast: {}", "fast: [1]", "fast: [", ["cases.fast", "dictionary"]),
    "case_name": ("fast: {}", "fast: {}\n  a/b: {}", "a/b", ["cases.a/b"]),
    "reversed_window": (
        "windows: [40-60 s, end]", "windows: [60-40 s, end]", "60-40 s",
        ["tables.layout.1.windows.0", "window", "'60-40 s'"],
    ),
    "window_without_unit": ("windows: [40-60 s, end]", "windows: [40-60]", "40-60]", ["window"]),
    "scored_window": (
        "scored_window: 40-60 s", "scored_window: late", "scored_window", ["'late'"],
    ),
    "unknown_statistic": (
        "statistics: [mean]", "statistics: [avarage]", "avarage",
        ["'avarage'", "allowed", "rmse"],
    ),
    "unknown_quantity": (
        "[rate_1, pitch]", "[rate_1, pich]", "pich", ["'pich'", "allowed", "pitch"],
    ),
    "quantity_without_table_unit": ("[rate_1, pitch]", "[rate_b]", "rate_b]", ["'rate_b'"]),
    "unknown_case_in_a_mean": (
        "mean: [slow, fast]", "mean: [slow, fats]", "mean: [slow",
        ["unknown case 'fats'", "did you mean fast?"],
    ),
    "unknown_case_in_a_table": (
        "windows: [0-60 s]\n    - table: \"2\"",
        "windows: [0-60 s]\n      cases: [slw]\n    - table: \"2\"",
        "cases: [slw]", ["unknown case 'slw'", "did you mean slow?"],
    ),
    "filter_without_start": (
        "    start: *start\n", "", "wahba:\n", ["needs all three", "start"],
    ),
    "sensor_without_a_kind": (
        SENSOR, "{noise_m: 0.1}", "points: {noise_m", ["sensors.points.kind", "missing"],
    ),
    "one_epoch": ("duration_s: 60", "duration_s: 1.5", "step_s", ["1.5 epochs"]),
    "tab": ("seed: 7", "\tseed: 7", "\tseed", ["not valid YAML"]),
    "unclosed": ("fast: {}", "fast: {", None, ["not valid YAML"]),
}  # fmt: skip


# a key that is wrong is also missing; an anchor is used by two estimators
TOLD = {"wrong_unit": 2, "misspelt_filter": 2}


def place_of(text: str, fragment: str) -> str:
    """Return ``line:column`` of a fragment that stands once in a text."""
    before = text[: text.index(fragment)]
    return f"{before.count(chr(10)) + 1}:{len(before) - (before.rfind(chr(10)) + 1) + 1}"


def edited(config: Path, old: str, new: str) -> str:
    text = config.read_text()
    assert old in text
    config.write_text(text.replace(old, new, 1))
    return config.read_text()


@pytest.mark.parametrize("name", BAD)
def test_each_mistake_is_told_with_its_place(name: str, small: Path, sweep: Any) -> None:
    old, new, fragment, words = BAD[name]
    text = edited(small, old, new)
    result = sweep(small, small.parent / "out")
    assert result.exit_code == 2
    assert result.stdout == ""
    lines = result.stderr.splitlines()
    assert len(lines) == TOLD.get(name, 1)
    assert all(re.match(rf"{re.escape(str(small))}:\d+:\d+: ", line) for line in lines), lines
    if fragment is not None:
        at = f"{small}:{place_of(text, fragment)}: "
        lines = [line for line in lines if line.startswith(at)]
    assert any(all(word in line for word in words) for line in lines), result.stderr
    assert sorted(p.name for p in small.parent.iterdir()) == ["small.csv", "small.yaml"]


def test_a_text_in_the_inertia_is_told_once(small: Path, sweep: Any) -> None:
    text = edited(small, "[0.618, 0.707, 0.345]", "[0.618, heavy, 0.345]")
    lines = sweep(small, small.parent / "out").stderr.splitlines()
    assert len(lines) == 1
    assert lines[0].startswith(f"{small}:{place_of(text, 'heavy')}: ")


def test_an_observer_without_an_orbit_is_told_at_the_observer(small: Path, sweep: Any) -> None:
    text = edited(small, "orbit: {kind: kepler, semi_major_axis_km: 7178.137}\n", "")
    result = sweep(small, small.parent / "out")
    assert result.exit_code == 2
    assert all(w in result.stderr for w in ("hold", "orbit_position", "orbit kepler"))
    assert not (small.parent / "out").exists()
    assert result.stderr.startswith(f"{small}:{place_of(text, 'chaser: {')}: ")


def test_a_window_beyond_the_end_is_told(small: Path, sweep: Any) -> None:
    text = edited(small, "windows: [40-60 s, end]", "windows: [90-120 s, end]")
    result = sweep(small, small.parent / "out")
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{small}:{place_of(text, '90-120 s')}: ")


def test_an_instant_cannot_be_the_scored_window(small: Path, sweep: Any) -> None:
    edited(small, "scored_window: 40-60 s", "scored_window: end")
    assert sweep(small, small.parent / "out").exit_code == 2


def test_several_problems_are_told_at_once(small: Path, sweep: Any) -> None:
    edited(small, "seed: 7", "seed: -7\nseed: 8")
    edited(small, "noise_m: 1e-2", "noise_cm: 1")
    edited(small, "[0.618, 0.707, 0.345]", "[0.1, 0.2, 0.9]")
    edited(small, "statistics: [mean]", "statistics: [avarage]")
    result = sweep(small, small.parent / "out")
    assert result.exit_code == 2
    for word in ("already given", "seed: must", "noise_cm", "triangle", "'avarage'"):
        assert word in result.stderr


def test_problems_of_several_files_are_told_at_once(small: Path, cli: Any) -> None:
    other = small.with_name("other.yaml")
    other.write_text(small.read_text().replace("seed: 7", "seed: x"))
    edited(small, "seed: 7", "seed: y")
    result = cli("validate", small, other)
    assert result.exit_code == 2
    assert f"{small}:3:1: seed" in result.stderr
    assert f"{other}:3:1: seed" in result.stderr


FILES = {
    "empty": (b"", ":1:1: ", "empty"),
    "only_comments": (b"# nothing\n\n", ":1:1: ", "empty"),
    "binary": (bytes(range(256)), ": ", "not a text file"),
    "hdf5": (b"\x89HDF\r\n\x1a\n" + bytes(100), ": ", "not a text file"),
    "control_characters": (b"seed: \x07\n", ":", "YAML"),
    "list": (b"- 1\n- 2\n", ":1:1: ", "mapping"),
    "number": (b"5\n", ":1:1: ", "mapping"),
    "two_documents": (b"seed: 1\n---\nseed: 2\n", ":2:1: ", "YAML"),
}


@pytest.mark.parametrize("name", FILES)
def test_files_that_are_no_scenarios(name: str, tmp_path: Path, cli: Any) -> None:
    content, place, words = FILES[name]
    config = tmp_path / "odd.yaml"
    config.write_bytes(content)
    result = cli("sweep", config)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{config}{place}")
    assert words in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert config.read_bytes() == content
    assert list(tmp_path.iterdir()) == [config]


def test_a_file_that_is_missing(tmp_path: Path, cli: Any) -> None:
    result = cli("sweep", tmp_path / "none.yaml", "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{tmp_path / 'none.yaml'}: No such file")
    assert not (tmp_path / "out").exists()


def test_a_folder(tmp_path: Path, cli: Any) -> None:
    result = cli("sweep", tmp_path)
    assert result.exit_code == 2
    assert "folder" in result.stderr


OPTIONS = {
    "unknown_case": (["--case", "slwo"], ["--case slwo", "did you mean slow?"]),
    "unknown_estimator": (["--estimator", "wabha"], ["--estimator wabha", "did you mean wahba?"]),
    "unknown_key": (
        ["--set", "sensors.points.noise=1"], ["--set sensors.points.noise=1", "noise_m?"],
    ),
    "unknown_top_key": (["--set", "sed=1"], ["--set sed=1", "did you mean seed?"]),
    "bad_value": (["--set", "seed=x"], ["--set seed=x", "integer", "'x'"]),
    "physics": (["--set", "target.inertia_kg_m2=[1, 1, 3]"], ["--set target", "triangle"]),
    "no_value": (["--set", "seed="], ["--set seed=", "integer"]),
    "no_equals_sign": (["--set", "seed"], ["--set seed", "key.path=value"]),
    "no_key": (["--set", "=5"], ["--set =5", "key.path=value"]),
    "hole_in_key": (["--set", "a..b=5"], ["--set a..b=5", "key.path=value"]),
    "broken_yaml": (["--set", "seed=[1"], ["--set seed=[1", "YAML"]),
    "cases": (["--set", "cases.slow.seed=1"], ["cannot be set", "every case"]),
    "grid": (["--set", "grid={}"], ["cannot be set"]),
    "cluster": (["--executor", "tcp://here"], ["--executor tcp://here", "dask:tcp://HOST:PORT"]),
    "no_runs": (["--runs", "0"], ["--runs"]),
    "no_jobs": (["--jobs", "0"], ["--jobs"]),
}  # fmt: skip


@pytest.mark.parametrize("name", OPTIONS)
def test_bad_options(name: str, small: Path, sweep: Any) -> None:
    options, words = OPTIONS[name]
    result = sweep(small, small.parent / "out", *options)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert all(word in result.stderr for word in words), result.stderr
    assert not list(small.parent.rglob("*.h5"))


def test_an_override_of_an_unknown_estimator_says_so(small: Path, sweep: Any) -> None:
    result = sweep(small, small.parent / "out", "--set", "estimators.wabha.filter.alpha=0.5")
    assert result.exit_code == 2
    assert "did you mean wahba?" in result.stderr


CSV = "table,case,quantity,statistic,window,published,factor,triad,wahba\n"
BAD_CSV = {
    "missing": (None, [": "]),
    "empty": ("", [":1: missing column table"]),
    "missing_column": (CSV.replace("factor,", ""), [":1: missing column factor"]),
    "bad_number": (CSV + "1,slow,pitch,rmse,0-60 s,about one,1.6,,\n", [":2: ", "about one"]),
    "bad_verdict": (CSV + "1,slow,pitch,rmse,0-60 s,1,1.6,great,\n", [":2: ", "great"]),
    "not_a_number": (CSV + "1,slow,pitch,rmse,0-60 s,nan,1.6,,\n", [":2: "]),
    "zero_factor": (CSV + "1,slow,pitch,rmse,0-60 s,1,0,,\n", [":2: "]),
    "short_row": (CSV + "1,slow,pitch\n", [":2: "]),
    "long_row": (CSV + "1,slow,pitch,rmse,0-60 s,1,1.6,,,better,worse\n", [":2: "]),
    "binary": (b"\x89\xff\x00\x01", []),
    "row_twice": (CSV + 2 * "1,slow,pitch,rmse,0-60 s,1,2,,\n", [":3: ", "given in line 2"]),
    "column_twice": (CSV.replace("wahba", "triad"), [":1: ", "'triad' is there 2 times"]),
    "estimator": (CSV.replace("wahba", "whaba"), [":1: ", "'whaba'", "did you mean wahba?"]),
    "table": (CSV + "3,slow,pitch,rmse,0-60 s,1,2,,\n", [":2: ", "no table '3'", "1, 2, filter"]),
    "case": (CSV + "1,slwo,pitch,rmse,0-60 s,1,2,,\n", [":2: ", "no case", "mean slow?"]),
    "quantity": (CSV + "2,slow,pich,rmse,end,1,2,,\n", [":2: ", "no quantity", "mean pitch?"]),
    "statistic": (CSV + "2,slow,pitch,rsme,end,1,2,,\n", [":2: ", "no statistic", "mean rmse?"]),
    "window": (CSV + "1,slow,pitch,rmse,0-60s,1,2,,\n", [":2: ", "a window", "'0-60s'"]),
    "verdict": (CSV + "1,slow,pitch,rmse,0-60 s,1,2,beter,\n", [":2: ", "mean better?"]),
}


def test_every_mistake_of_published_values_is_told(small: Path, cli: Any) -> None:
    rows = "1,slwo,pitch,rmse,0-60 s,1,2,,\n1,slow,pich,rmse,0-60 s,1,2,,\n"
    small.with_name("small.csv").write_text(CSV + rows)
    told = cli("validate", small).stderr.splitlines()
    assert [line.split(":")[1] for line in told] == ["2", "3"]


@pytest.mark.parametrize("published", ["/dev/zero", ".", "/dev/null/x"])
def test_published_values_are_a_file(published: str, small: Path, cli: Any) -> None:
    edited(small, "published: small.csv", f"published: {published}")
    result = cli("validate", small)
    assert result.exit_code == 2
    assert "published values" in result.stderr
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize("name", BAD_CSV)
def test_published_values_are_checked(name: str, small: Path, swept: Path, cli: Any) -> None:
    content, words = BAD_CSV[name]
    file = small.with_name("small.csv")
    if content is None:
        file.unlink()
    else:
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
    result = cli("table", small, "--out", swept)
    assert result.exit_code == 2
    assert len(result.stderr.splitlines()) == 1
    assert str(file) in result.stderr
    assert all(word in result.stderr for word in words), result.stderr


def test_published_values_are_checked_before_anything_runs(small: Path, sweep: Any) -> None:
    small.with_name("small.csv").unlink()
    assert sweep(small, small.parent / "out").exit_code == 2
    assert not (small.parent / "out").exists()


def test_published_values_with_a_byte_order_mark(small: Path, swept: Path, cli: Any) -> None:
    file = small.with_name("small.csv")
    file.write_text(file.read_text(), encoding="utf-8-sig")
    assert cli("table", small, "--out", swept).exit_code == 0


def test_a_case_with_an_estimator_of_its_own(small: Path, sweep: Any) -> None:
    edited(small, "  slow: {", "  slow: {estimators: {own: {recovery: {kind: basis_pursuit, "
           "attitude: triad, penalty: 1}}}, ")  # fmt: skip
    result = sweep(small, small.parent / "out", "--dry-run")
    assert result.exit_code in (0, 2)
    assert result.exit_code == 0 or str(small) in result.stderr


@pytest.mark.parametrize("name", [".", ".."])
def test_case_names_stay_in_their_folder(name: str, small: Path, cli: Any) -> None:
    edited(small, "  fast: {}", f'  fast: {{}}\n  "{name}": {{}}')
    assert cli("validate", small).exit_code == 2


def test_two_scenarios_of_one_name_do_not_share_a_folder(small: Path, cli: Any) -> None:
    other = small.parent / "other" / "small.yaml"
    other.parent.mkdir()
    other.write_text(small.read_text().replace("seed: 7", "seed: 8"))
    other.with_name("small.csv").write_text(small.with_name("small.csv").read_text())
    result = cli("sweep", small, other, "--out", small.parent / "out", "--dry-run")
    assert result.exit_code == 2


# values of YAML that its own loader trips over
ODD_VALUES = {
    "recursive": "&loop [*loop]",
    "deep": "[" * 1200 + "]" * 1200,
    "tagged_integer": "!!int seven",
    "tagged_float": "!!float much",
    "tagged_bool": "!!bool perhaps",
    "tagged_date": "!!timestamp today",
    "tagged_set": "!!set {a, b}",
    "unknown_tag": "!secret 5",
    "python_tag": "!!python/object:os.system {}",
    "long_integer": "9" * 5000,
    "huge_integer": "9" * 400,
    "date": "2020-01-01",
    "base_60": "1:30",
    "alias_of_nothing": "*nothing",
    "merge_key": "{<<: {a: 1}}",
    "complex_key": "{[1, 2]: 3}",
    "mapping_as_key": "{{a: 1}: 3}",
    "null_key": "{~: 3}",
}


@pytest.mark.parametrize("name", ODD_VALUES)
def test_odd_values_are_refused(name: str, small: Path) -> None:
    edited(small, "duration_s: 60", f"duration_s: {ODD_VALUES[name]}")
    with pytest.raises(UserError):
        load_scenario(small)


@pytest.mark.parametrize("name", ["date", "base_60"])
def test_what_other_loaders_read_as_a_date_or_a_number_is_a_text(name: str, small: Path) -> None:
    edited(small, "title: A small tumbling body", f"title: {ODD_VALUES[name]}")
    assert load_scenario(small).common.title == ODD_VALUES[name]


def test_a_seed_that_no_file_can_hold_is_refused(small: Path, sweep: Any) -> None:
    edited(small, "seed: 7", f"seed: {2**70}")
    result = sweep(small, small.parent / "out", "--case", "slow", "--runs", 1)
    assert result.exit_code in (0, 2), result.stderr


# what is right


def test_shipped_scenarios_are_valid(shipped: Path, cli: Any) -> None:
    result = cli("validate", *sorted(shipped.glob("*.yaml")))
    assert result.exit_code == 0
    assert "biondi2017.yaml: 11 cases, estimators: printed, reproduction, wahba" in result.stdout


@pytest.mark.parametrize(
    ("written", "value"),
    [("1e-6", 1e-6), ("1E-6", 1e-6), ("2", 2.0), ("+.5", 0.5), ("1.e2", 100.0), ("0.25", 0.25)],
)
def test_numbers(written: str, value: float, small: Path) -> None:
    edited(small, "noise_m: 1e-2", f"noise_m: {written}")
    sensor = load_scenario(small).common.sensors["points"]
    assert sensor.noise_m == value
    assert isinstance(sensor.noise_m, float)


def noise(config: Path, case: str, *overrides: str) -> tuple[float, str]:
    sensor = load_scenario(config, overrides).cases[case].scenario.sensors["points"]
    return sensor.noise_m, sensor.visibility


def test_precedence(small: Path) -> None:
    override = "sensors.points.noise_m=0.4"
    edited(small, "fast: {}", "fast: {sensors: {points: {noise_m: 0.3, visibility: back_face}}}")
    assert noise(small, "slow") == (0.01, "all")
    assert noise(small, "fast") == (0.3, "back_face")
    assert noise(small, "slow", override) == (0.4, "all")
    assert noise(small, "fast", override) == (0.4, "back_face")
    assert noise(small, "fast", override, "sensors.points.noise_m=0.5") == (0.5, "back_face")
    edited(small, ", visibility: all", "")
    assert noise(small, "slow") == (0.01, "back_face")


def test_a_list_in_a_case_replaces_the_list(small: Path) -> None:
    cases = load_scenario(small).cases
    assert cases["slow"].scenario.motion.rate_deg_s == [3.0, 2.0, -1.0]
    assert cases["fast"].scenario.motion.rate_deg_s == [7.2, 5.5, -1.6]


def test_another_kind_replaces_the_whole_mapping(small: Path) -> None:
    drift = "{kind: drift, position_m: [0, 30, 0]}"
    edited(
        small,
        "{kind: hold, position_m: [0, 30, 0]}",
        drift.replace("}", ", velocity_m_s: [1, 0, 0]}"),
    )
    edited(small, "fast: {}", "fast: {observers: {chaser: {kind: hold, position_m: [0, 9, 0]}}}")
    cases = load_scenario(small).cases
    assert cases["slow"].scenario.observers["chaser"].velocity_m_s == [1, 0, 0]
    hold = cases["fast"].scenario.observers["chaser"]
    assert (hold.kind, hold.position_m) == ("hold", [0, 9, 0])


def test_another_kind_keeps_what_it_requires_too_and_no_more(small: Path) -> None:
    edited(small, "{kind: hold, position_m: [0, 30, 0]}", FREE)
    cases = load_scenario(small, ["observers.chaser.kind=hold"]).cases
    assert cases["slow"].scenario.observers["chaser"].model_dump(exclude={"kind"}) == {
        "position_m": [0, 20, 0]
    }
    rates = [load_scenario(small, over).cases["fast"].scenario.motion.rate_deg_s for over in SPUN]
    assert rates == [[7.2, 5.5, -1.6], [7.2, 5.5, -1.6], [1, 2, 3]]


FREE = "{kind: drift, position_m: [0, 20, 0], velocity_m_s: [1, 0, 0]}"
SPUN: list[list[str]] = [
    [],
    ["motion.kind=gravity_gradient"],
    ["motion={kind: gravity_gradient, rate_deg_s: [1, 2, 3]}"],
]
GRID = "grid: {sensors.points.noise_m: [0.01, 0.02], step_s: [1, 2, 3]}\n"


def test_a_grid_makes_cases(small: Path) -> None:
    text = small.read_text()
    small.write_text(text[: text.index("tables:")] + GRID)
    cases = load_scenario(small).cases
    assert list(cases) == [f"noise_m={n},step_s={s}" for n in (0.01, 0.02) for s in (1, 2, 3)]
    for name, case in cases.items():
        given = case.scenario.sensors["points"].noise_m, case.scenario.step_s
        assert name == f"noise_m={given[0]},step_s={given[1]:g}"


def test_a_grid_multiplies_with_cases(small: Path) -> None:
    edited(small, "    mean: [slow, fast]\n", "    mean: []\n")
    small.write_text(small.read_text() + GRID)
    cases = load_scenario(small).cases
    assert len(cases) == 12
    slow = cases["slow,noise_m=0.02,step_s=3"].scenario
    assert slow.motion.rate_deg_s == [3.0, 2.0, -1.0]
    assert (slow.sensors["points"].noise_m, slow.step_s) == (0.02, 3)


def test_a_bad_value_in_a_grid_is_told_at_the_grid(small: Path, cli: Any) -> None:
    small.write_text(small.read_text() + "grid:\n  sensors.points.noise_m: [0.01, -0.02]\n")
    result = cli("validate", small)
    assert result.exit_code == 2
    assert f":{place_of(small.read_text(), 'sensors.points.noise_m')}: sensors.points.noise_m" in (
        result.stderr
    )


def test_a_scenario_without_cases_is_one_case(small: Path) -> None:
    text = small.read_text()
    small.write_text(text[: text.index("tables:")])
    assert list(load_scenario(small).cases) == ["nominal"]


# the JSON schema, checked by a small interpreter of the keywords that it uses


def accepts(schema: dict[str, Any], value: Any, root: dict[str, Any]) -> bool:
    if "$ref" in schema:
        return accepts(root["$defs"][schema["$ref"].rsplit("/", 1)[-1]], value, root)
    if any(key in schema for key in ("anyOf", "oneOf")):
        return any(accepts(s, value, root) for s in schema.get("anyOf") or schema["oneOf"])
    if "const" in schema:
        return value == schema["const"]
    if "enum" in schema:
        return value in schema["enum"]
    types: dict[str, Any] = {
        "object": dict, "array": list, "string": str, "integer": int, "number": (int, float),
        "boolean": bool, "null": type(None),
    }  # fmt: skip
    if "type" in schema and not isinstance(value, types[schema["type"]]):
        return False
    if isinstance(value, dict):
        return accepts_keys(schema, value, root)
    if isinstance(value, list):
        length = schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", 1e9)
        return length and all(accepts(schema.get("items", {}), item, root) for item in value)
    if isinstance(value, int | float):
        return not (value < schema.get("minimum", value) or value <= schema.get(
            "exclusiveMinimum", value - 1))  # fmt: skip
    return True


def accepts_keys(schema: dict[str, Any], value: dict[str, Any], root: dict[str, Any]) -> bool:
    if not set(schema.get("required", [])) <= value.keys():
        return False
    for key, inner in value.items():
        below = schema.get("properties", {}).get(key)
        for pattern, of in schema.get("patternProperties", {}).items():
            below = of if below is None and re.search(pattern, key) else below
        below = schema.get("additionalProperties", True) if below is None else below
        if below is False or (below is not True and not accepts(below, inner, root)):
            return False
    return True


def test_the_json_schema_accepts_the_shipped_scenarios(shipped: Path, cli: Any) -> None:
    from debrisest.scenario.document import parse

    schema = json.loads(cli("schema").stdout)
    assert schema["type"] == "object"
    for path in sorted(shipped.glob("*.yaml")):
        document, problems = parse(path.read_text(), path.name)
        assert not problems
        assert accepts(schema, document.value, schema)
        assert not accepts(schema, document.value | {"sede": 1}, schema)
        assert not accepts(schema, document.value | {"motion": {"kind": "spinning"}}, schema)
        assert not accepts(schema, document.value | {"runs": 0}, schema)
        assert not accepts(schema, {k: v for k, v in document.value.items() if k != "seed"}, schema)
