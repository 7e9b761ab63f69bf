"""Names and texts that later stages cannot carry are refused with their place and the reason."""

import json
import os
import zlib
from pathlib import Path
from typing import Any

import pytest

from debrisest.errors import UserError
from debrisest.scenario.load import load_scenario

# what is replaced, by what, words of the message
REFUSED = {
    "escape_in_a_title": (
        "title: A small tumbling body", 'title: "\\e[31mA small"', ["small.yaml:1:8: ", "001B"],
    ),
    "nul_in_a_name": ("  wahba:", '  "wah\\0ba":', ["U+0000"]),
    "lone_surrogate": (
        "source: made for the tests", 'source: "\\ud800 made"', ["U+D800", "small.yaml:2:9: "],
    ),
    "raw_bell": ("made for", "made \x07 for", ["U+0007", "small.yaml:2:14: "]),
    "dot_in_an_estimator": ("  wahba:", "  ukf.v2:", ["ukf.v2", "a dot separates keys"]),
    "dot_in_a_sensor": ("  points: {kind", "  p.q: {kind", ["sensors.p.q", "dot"]),
    "long_estimator": ("  wahba:", f"  {'w' * 60}:", ["at most 50", "60"]),
    "long_case": ("  fast: {}", f"  {'f' * 101}: {{}}", ["at most 100", "101"]),
    "capitals": ("  fast: {}", "  fast: {}\n  Slow: {}", ["cases.Slow", "'slow'", "case"]),
    "capitals_of_estimators": ("  wahba:", "  Triad:", ["estimators.Triad", "'triad'"]),
    "reserved": ("  fast: {}", "  fast: {}\n  Tables.MD: {}", ["taken by a file"]),
    "reserved_by_a_report": ("  fast: {}", "  fast: {}\n  report.html: {}", ["taken by a file"]),
    "device": ("  fast: {}", "  fast: {}\n  aux.h5: {}", ["cases.aux.h5: Windows"]),
    "dot_at_the_end": ("  fast: {}", "  fast: {}\n  other.: {}", ["cases.other.: Windows"]),
    "direction": ("made for the tests", "made \u202ef\u202c tests", ["U+202E", "U+202C"]),
    "line_separator": ("    a: {position", '    "a\\u2028b": {position', ["U+2028", ":12:5: "]),
    "nothing_to_see": ("    a: {position", '    "a\\u200b": {position', ["U+200B", ":12:5: "]),
    "mark_of_direction": (
        "title: A small tumbling body", 'title: "\\u061cA\\u200f"', ["U+061C", "U+200F"],
    ),
    "tag": ("made for the tests", 'made \U000e0041 for', ["U+E0041", "small.yaml:2:"]),
    "formula": ('table: "2"', 'table: "=HYPERLINK(1)"', ["tables.layout.1.table", "=HYPERLINK"]),
    "case_twice_in_a_mean": (
        "mean: [slow, fast]", "mean: [slow, slow]", ["54:5: tables.means.mean: 'slow' is there 2"],
    ),
    "two_lines_in_a_sensor": ("  points: {kind", '  "p\\nq": {kind', ["sensors.p\\nq: a name has"]),
    "quantity_twice": (
        "[rate_1, pitch]", "[pitch, pitch]", ["tables.layout.1.quantities: 'pitch' is there 2"],
    ),
    "window_twice": ("[40-60 s, end]", "[end, end]", ["tables.layout.1.windows: 'end' is there"]),
    "mean": ("    mean: [", '    "=1+1": [', ["tables.means.=1+1"]),
    "nul_in_a_path": ("published: small.csv", 'published: "small\\0.csv"', ["U+0000"]),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_each_is_refused_with_place_and_reason(name: str, small: Path, cli: Any) -> None:
    old, new, words = REFUSED[name]
    text = small.read_text()
    assert old in text
    small.write_text(text.replace(old, new, 1))
    result = cli("validate", small)
    assert result.exit_code == 2
    assert result.stderr.startswith(f"{small}:")
    assert all(word in result.stderr for word in words), result.stderr
    assert "\x1b" not in result.stderr


@pytest.mark.parametrize(
    "stem", [".", "..", "=cmd", "-x", "a\tb", "x" * 101, "a.", "\udcff", "Nul", "com1.old", "a@b"]
)
def test_a_file_whose_name_cannot_be_a_folders(stem: str, small: Path, cli: Any) -> None:
    config = small.with_name(f"{stem}.yaml")
    config.write_text(small.read_text())
    result = cli("sweep", "--out", small.parent / "out", "--", config)
    assert result.exit_code == 2
    assert "rename" in result.stderr
    assert not (small.parent / "out").exists()


def test_a_grid_whose_names_are_too_long(small: Path, cli: Any) -> None:
    small.write_text(f"{small.read_text()}grid:\n  sensors.points.noise_m: ['{'1' * 95}']\n")
    result = cli("validate", small)
    assert result.exit_code == 2
    assert "letters" in result.stderr


@pytest.mark.parametrize("pair", [("plumless", "buckeroo"), ("codding", "gnu")])
def test_cases_that_would_draw_the_same_are_refused(
    pair: tuple[str, str], small: Path, cli: Any
) -> None:
    same = zlib.crc32(pair[0].encode()) == zlib.crc32(pair[1].encode())
    small.write_text(small.read_text() + "".join(f"  {name}: {{}}\n" for name in pair))
    result = cli("validate", small)
    assert (result.exit_code == 2) == same
    assert ("CRC-32" in result.stderr) == same


def test_devices_and_endless_files_are_no_scenarios(tmp_path: Path, cli: Any) -> None:
    (tmp_path / "zero.yaml").symlink_to("/dev/zero")
    with (tmp_path / "sparse.yaml").open("wb") as file:
        file.truncate(2**40)
    for name, why in (("zero", "device"), ("sparse", "MB")):
        result = cli("validate", tmp_path / f"{name}.yaml")
        assert (result.exit_code, why in result.stderr) == (2, True)


@pytest.mark.parametrize("kind", ["sparse", "zero", "pipe"])
def test_published_values_of_any_length_and_none_are_refused_at_once(
    kind: str, small: Path, cli: Any
) -> None:
    path = small.with_suffix(".csv")
    path.unlink()
    if kind == "sparse":
        with path.open("wb") as file:
            file.truncate(2**40)
    elif kind == "zero":
        path.symlink_to("/dev/zero")
    else:
        os.mkfifo(path)
    result = cli("validate", small)
    assert (result.exit_code, "published values cannot be read" in result.stderr) == (2, True)


def test_a_pipe_that_nobody_writes_to_is_no_scenario(tmp_path: Path, cli: Any) -> None:
    os.mkfifo(pipe := tmp_path / "pipe.yaml")
    result = cli("validate", pipe)
    assert (result.exit_code, result.stderr[:-1]) == (
        2,
        f"{pipe}: this is a pipe or a device, not a file; give the path of a scenario file (YAML)",
    )


def test_accents_in_one_sign_or_two_tell_no_scenarios_and_no_features_apart(
    small: Path, cli: Any
) -> None:
    twins = small.with_name("caf\u00e9.yaml"), small.parent / "b" / "Cafe\u0301.yaml"
    twins[1].parent.mkdir()
    for path in twins:
        path.write_text(small.read_text().replace("published: small.csv", "published: null"))
    result = cli("validate", *twins)
    assert (result.exit_code, result.stderr.count("results would be mixed")) == (2, 2)
    assert cli("validate", twins[0], small).exit_code == 0
    text = twins[0].read_text().replace("    c: {", "    \u00e9: {")
    twins[0].write_text(text.replace("    d: {", "    e\u0301: {"))
    result = cli("validate", twins[0])
    assert (result.exit_code, "two features have one name" in result.stderr) == (2, True)


@pytest.mark.parametrize("name", ["a\tb", "a\nb", " ", ""])
def test_features_have_names_that_figures_can_show(name: str, small: Path, cli: Any) -> None:
    text = small.read_text().replace("    b: {position", f"    {json.dumps(name)}: {{position")
    small.write_text(text)
    result = cli("validate", small)
    assert (result.exit_code, "is no name" in result.stderr) == (2, True)


def test_texts_beyond_the_basic_plane_are_texts(small: Path) -> None:
    import debrisest

    assert debrisest.load(small, title="Tumbling \U0001f6f0 é").common.title == "Tumbling 🛰 é"


def test_what_is_told_has_no_control_characters() -> None:
    (told,) = UserError("--case \x1b[2J\ud800").problems
    assert told == "--case \\x1b[2J\\ud800"
    assert UserError("a\u3164\u034f").problems == ["a\\u3164\\u034f"]
    assert UserError("a\u200eb\U000e0041\r\n\tc").problems == ["a\\u200eb\\U000e0041\\r\n\tc"]


def test_titles_are_one_line(small: Path) -> None:
    text = small.read_text().replace("title: A small tumbling body", "title: |\n  two\n  lines\n")
    small.write_text(text)
    assert load_scenario(small).common.title == "two lines"


def test_draws_that_would_be_the_same_are_refused(small: Path, cli: Any) -> None:
    first, second = "v6745-12053", "n16051x"
    assert zlib.crc32(first.encode()) == zlib.crc32(second.encode())
    text = small.read_text().replace("  slow: {", f"  slow: {{draws: {first}, ")
    small.write_text(text.replace("  fast: {}", f"  fast: {{draws: {second}}}"))
    told = cli("validate", small)
    line = text[: text.index("  fast: {}")].count("\n") + 1
    assert told.exit_code == 2
    assert told.stderr.startswith(f"{small}:{line}:10: cases.fast.draws: beside {first!r}: the ")
    small.write_text(text.replace("  fast: {}", f"  fast: {{draws: {first}}}"))
    assert cli("validate", small).exit_code == 0
